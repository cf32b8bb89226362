"""Records of finished work, compared by their inputs: stages, episodes, packed recordings, proofs, clips."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, Protocol, Self, TypeVar

from vcage.base.errors import InputFileError


class WorkRecord(Protocol):
    """A record of finished work, such as a :class:`~vcage.schema.base.StageDocument`."""

    @property
    def made_from(self) -> Any:
        """Everything that the work depends on; equal inputs give the same work."""

    @classmethod
    def read(cls, path: Path) -> Self:
        """The record in a file.

        Raises:
            MissingStage: the file is not there.
            InputFileError: it is damaged or of another schema.
        """


K = TypeVar("K", bound=WorkRecord)


@dataclass(frozen=True)
class Keeper(Generic[K]):
    """The record of a piece of work, and the inputs that the work would have today.

    Args:
        path: of the record, which is written last: its existence means complete work.
        record: its type.
        made_from: compared with that of the record.
    """

    path: Path
    record: type[K]
    made_from: Any

    def found(self) -> K:
        """Read the record, whatever its inputs.

        Raises:
            MissingStage: there is none.
            InputFileError: it is damaged or of another schema.
        """
        return self.record.read(self.path)

    def knows(self, record: K) -> bool:
        """True if a record was made from the same inputs."""
        return record.made_from == self.made_from

    def kept(self) -> K | None:
        """Return the record of work with the same inputs; None where it is missing, damaged, or has other inputs."""
        with contextlib.suppress(InputFileError):
            record = self.found()
            return record if self.knows(record) else None
        return None
