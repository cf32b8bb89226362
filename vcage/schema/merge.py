"""Record of a merge: its data sets, and what they do not hold."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from vcage.schema.base import Document, Record


class LeftOut(Record):
    """A run, or an episode of it, that could not be added."""

    run: str = Field(description="its folder, from the one that was given")
    episode: str | None = Field(description="its file in the run; none where the whole run is left out")
    code: str = Field(description="of the error, such as damaged_file")
    reason: str


class Repeated(Record):
    """An episode that a data set holds already, from another run."""

    run: str
    episode: str
    number: int = Field(description="of the one that the data set holds")


class MergedSet(Record):
    """One data set."""

    format: str
    group: str = Field(description="of runs that fit together; empty where all do")
    path: str = Field(description="from the folder of this record")
    episodes: int
    frames: int
    splits: dict[str, str] = Field(description="name → range of its episodes, the end excluded")


class Merge(Document):
    """``merge.json`` beside the merged data sets. An interrupted and repeated merge leaves the same as another."""

    SCHEMA: ClassVar[str] = "vcage.merge/1"

    runs: int = Field(description="that were found")
    datasets: list[MergedSet]
    left_out: list[LeftOut]
    repeated: list[Repeated]
