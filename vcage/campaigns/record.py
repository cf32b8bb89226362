"""The state of a job: its record when it is settled, and its tries until then."""

from __future__ import annotations

import contextlib
import logging
from pathlib import Path
from typing import ClassVar, Literal, Self

from pydantic import Field, model_validator

from vcage.base.errors import DamagedFile, InputFileError, SchemaMismatch
from vcage.base.files import read_json
from vcage.base.reading import read_regular
from vcage.campaigns.plan import Seed, job_id
from vcage.schema.base import Document, Finite, Record
from vcage.schema.episodes import CriticCounts, Spread

logger = logging.getLogger(__name__)

DAMAGED = "the next campaign command settles its job again"

State = Literal["done", "failed", "given_up"]
"""States of a settled job.

- ``done``: the chain ran to its end, with as many verified episodes as it found;
- ``failed``: another try would end with the same error;
- ``given_up``: too many tries got no further.
"""


class JobError(Record):
    """The reason why a job is not done."""

    code: str
    message: str


class JobRecord(Document):
    """``jobs/<cell>/<number>.job.json``: a settled job.

    Example:
        >>> JobRecord.read(Path("campaigns/desk/jobs/blocks_aloha-agilex_varied_light_0/0000.job.json")).verified
    """

    SCHEMA: ClassVar[str] = "vcage.job/1"

    cell: str
    number: int = Field(ge=0)
    seed: Seed
    state: State
    episodes: int = Field(gt=0, description="asked for, of each chain")
    asked: int = Field(ge=0, description="verified episodes that were asked for in all")
    verified: int = Field(default=0, ge=0)
    tried: int = Field(default=0, ge=0, description="episodes that were run")
    attempts: int = Field(default=0, ge=0, description="attempts at sub-tasks")
    rejected: dict[str, int] = Field(default={}, description="reason → episodes")
    critic: CriticCounts | None = None
    spread: dict[str, Spread] = Field(default={}, description="object → where it started, in the verified episodes")
    seconds: Finite = Field(default=0.0, ge=0, description="wall time of the try that settled it")
    cpu_seconds: Finite = Field(default=0.0, ge=0, description="of that try, in all its processes")
    bytes: int = Field(default=0, ge=0, description="of its run folder, files with several names once")
    files: int = Field(default=0, ge=0, description="files and folders in it, likewise")
    memory_bytes: int = Field(default=0, ge=0, description="largest, of the process that ran it")
    tries: int = Field(ge=1)
    error: JobError | None = None
    host: str
    ended: str = Field(description="when, UTC, ISO 8601")

    @model_validator(mode="after")
    def _counts_agree(self) -> Self:
        if self.verified > self.tried:
            raise ValueError(f"expected at most as many verified episodes as were tried, {self.tried}")
        return self

    @property
    def job_id(self) -> str:
        """The id of its job."""
        return job_id(self.cell, self.number)


class Tries(Record):
    """``jobs/<cell>/<number>.tries.json``: the tries that were begun since the job last got further."""

    count: int = Field(default=0, ge=0)
    total: int = Field(default=0, ge=0, description="all tries")
    open: bool = Field(default=False, description="the last one has not ended yet, or its process was lost")
    reached: tuple[int, int] = Field(default=(0, 0), description="stages finished, files in the run folder")
    error: JobError | None = Field(default=None, description="of the last try, if it could say")


def read_record(path: Path) -> JobRecord:
    """Read a record.

    Raises:
        MissingStage: there is none.
        DamagedFile: it is cut, or otherwise no record.
        SchemaMismatch: it is of another version.
        InputFileError: it may not be read.
    """
    try:
        return _read_at_once(path) or JobRecord.read(path)
    except SchemaMismatch as error:
        if isinstance(error.details.get("found"), str):
            error.hint = "it was written by another version: go on with that one, or remove it"
            raise
        raise DamagedFile(error.message, hint=DAMAGED) from error
    except DamagedFile as error:
        error.hint = DAMAGED
        raise


def _read_at_once(path: Path) -> JobRecord | None:
    """Read a record in half the time and memory; None where that does not work, to find out why."""
    data = read_regular(path, "a record")
    try:
        record = JobRecord.model_validate_json(data)
    except ValueError:
        return None
    if "schema_id" not in record.model_fields_set or record.schema_id != JobRecord.SCHEMA:
        return None
    record.model_fields_set.clear()  # these names, which nobody reads, take a third of its room
    return record


def warn_if_damaged(error: InputFileError) -> None:
    """Warn of a damaged record; raise the error of one that is of another version, or may not be read."""
    if not isinstance(error, DamagedFile):
        raise error
    logger.warning("%s", error.as_line())


def read_tries(path: Path) -> Tries:
    """Read tries; none where they cannot be read."""
    with contextlib.suppress(InputFileError, ValueError):
        return Tries.model_validate(read_json(path))
    return Tries()
