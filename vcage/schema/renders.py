"""``renders/renders.json``: the recorded states of a run's episodes, drawn again under other looks."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from vcage.schema.base import Record, RunPath, StageDocument


class Render(Record):
    """One episode under one other look; what was drawn is in the file's ``meta/randomisation``."""

    episode: int = Field(ge=0, description="number of the episode in the run")
    look: int = Field(ge=0, description="number of the look, from 0")
    ranges: str = Field(description="name of the ranges that the look was drawn from")
    seed: int = Field(ge=0, description="of the looks")
    file: RunPath = Field(description="path in the run folder")
    frames: int = Field(ge=1)


class Renders(StageDocument):
    """All renders of a run, of earlier calls of ``vcage render`` too."""

    SCHEMA: ClassVar[str] = "vcage.renders/2"

    renders: list[Render]
