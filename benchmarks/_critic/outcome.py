"""An outcome of a sub-task: what a critic is asked about it and shown, and what is true. A folder of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from vcage.base.errors import InputFileError
from vcage.base.pictures import read_picture, write_picture
from vcage.schema.base import Document, Record
from vcage.schema.goals import Goal
from vcage.schema.scene import Scene
from vcage.tasks.setting import Seen

Part = Literal["tuning", "untouched"]

SUCCESS = "success"
"""What successes as they came are filed under; those that were made ugly have names of their own."""

README = """# Outcomes of manipulation sub-tasks, for critics

`outcomes.json` lists them; `vcage.benchmarks.outcomes/1`. Of each: `text`, what the robot was asked for; `goals`, the
same as (subject, relation, reference, part); `success` and `reason`, what the simulator's state says; `kind`, how the
failure was made, or what kind of success it is; `part`, whether it may be looked at while a critic is tuned;
`pictures`, by when they were taken (before, after, at the moment that tells most, at the start) and by which camera;
`empty`, the table from above with nothing on it in the same light. `scene` is the file that names the objects, their
words and looks, and the calibration of the camera above the table. Pictures are PNG, 8 bits, RGB.

A critic is shown text, goals, pictures and the scene's objects, and says yes or no. Truth is for counting alone.
"""


class OutcomeRecord(Record):
    """One outcome, its pictures by path."""

    id: str
    scene: str = Field(description="path of the scene's document, relative to the folder")
    setting: str = Field(description="name of the scene")
    part: Part
    template: str
    text: str
    goals: list[Goal]
    requires: list[Goal] = []
    grasped: str | None = None
    asset: str = Field(description="kind of the object that the sub-task is about")
    success: bool
    reason: str
    kind: str
    pictures: dict[str, dict[str, str]] = Field(description="when → camera → path, relative to the folder")
    empty: str


class OutcomeList(Document):
    """``outcomes.json``."""

    SCHEMA: ClassVar[str] = "vcage.benchmarks.outcomes/1"

    outcomes: list[OutcomeRecord]


@dataclass(frozen=True)
class Outcome:
    """One outcome with its pictures.

    Args:
        record: what is asked, and what is true.
        scene: where it was done.
        seen: (H, W, 3) uint8 RGB pictures, by when and camera.
        empty: (H, W, 3) uint8, the empty table from above.
    """

    record: OutcomeRecord
    scene: Scene
    seen: Seen
    empty: np.ndarray

    def write(self, folder: Path) -> None:
        """Leave pictures and scene in a folder; the list is written by :func:`write_list`."""
        for when, shown in self.record.pictures.items():
            for camera, path in shown.items():
                write_picture(folder / path, self.seen[when][camera])
        write_picture(folder / self.record.empty, self.empty)
        self.scene.write(folder / self.record.scene)


def picture_paths(name: str, seen: Mapping[str, Mapping[str, np.ndarray]]) -> dict[str, dict[str, str]]:
    """Where the pictures of an outcome lie in its folder."""
    return {when: {camera: f"{name}/{when}-{camera}.png" for camera in shown} for when, shown in seen.items()}


def write_list(records: list[OutcomeRecord], folder: Path) -> None:
    """Write what describes a folder of outcomes."""
    OutcomeList(outcomes=records).write(folder / "outcomes.json")
    (folder / "README.md").write_text(README, encoding="utf-8")


def read_outcomes(folder: Path) -> Iterator[Outcome]:
    """The outcomes of a folder, one at a time.

    Raises:
        InputFileError: the folder has no list of outcomes, or lacks a file of one.
    """
    listed = folder / "outcomes.json"
    if not listed.exists():
        raise InputFileError(
            f"{listed} does not exist", hint="python -m benchmarks critic --keep DIR writes such a folder"
        )
    scenes: dict[str, Scene] = {}
    for record in OutcomeList.read(listed).outcomes:
        scene = scenes.setdefault(record.scene, Scene.read(folder / record.scene))
        seen = {
            when: {camera: read_picture(folder / path) for camera, path in shown.items()}
            for when, shown in record.pictures.items()
        }
        yield Outcome(record, scene, seen, read_picture(folder / record.empty))
