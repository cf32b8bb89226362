"""An outcome of a sub-task: what a critic is asked about it and shown, and what is true. A folder of them, in which the
name of nothing but ``truth.json`` tells what is true."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Literal

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
"""Kind of the successes as they came; those that were made ugly have names of their own."""

README = """# Outcomes of manipulation sub-tasks, for critics

`outcomes.json` lists what a critic is asked; `vcage.benchmarks.outcomes/2`. Of each outcome: `id`, a number that says
nothing; `text`, what the robot was asked for; `goals`, the same as (subject, relation, reference, part); `part`,
whether it may be looked at while a critic is tuned; `pictures`, by when they were taken (before, after, at the moment
that tells most, at a later one, at the start) and by which camera; `empty`, the table from above with nothing on it in
the same light. `scene` is the file that names the objects, their words and looks, and the calibration of the camera
above the table. Pictures are PNG, 8 bits, RGB.

A critic is shown text, goals, pictures and the scene's objects, and says yes or no.

`truth.json` says by `id` what is true; `vcage.benchmarks.outcome_truths/1`: `success` and `reason`, what the
simulator's state says; `kind`, how the failure was made, or what kind of success it is; and what it was made from. It
is for counting alone: a judge is blind as long as it does not open this file, and it can be moved away until the
judge is done.
"""

LIST, TRUTHS = "outcomes.json", "truth.json"
"""Files of a folder of outcomes."""


class OutcomeQuestion(Record):
    """The question to a critic about an outcome, pictures by path; it says nothing of what is true."""

    id: str = Field(description="a number, and the folder of its files")
    scene: str = Field(description="path of the scene's document, relative to the folder")
    part: Part
    text: str
    goals: list[Goal]
    requires: list[Goal] = []
    grasped: str | None = None
    pictures: dict[str, dict[str, str]] = Field(description="when → camera → path, relative to the folder")
    empty: str


class OutcomeTruth(Record):
    """The truth about an outcome, and its source."""

    name: str = Field(description="scene, draw, number of the sub-task and kind")
    setting: str = Field(description="name of the scene")
    template: str
    asset: str = Field(description="kind of the object that the sub-task is about")
    success: bool
    reason: str
    kind: str


class OutcomeRecord(OutcomeQuestion, OutcomeTruth):
    """One outcome: the critic's question and the truth."""


class OutcomeList(Document):
    """``outcomes.json``."""

    SCHEMA: ClassVar[str] = "vcage.benchmarks.outcomes/2"

    outcomes: list[OutcomeQuestion]


class OutcomeTruths(Document):
    """``truth.json``."""

    SCHEMA: ClassVar[str] = "vcage.benchmarks.outcome_truths/1"

    truths: dict[str, OutcomeTruth] = Field(description="by id of the outcome")


@dataclass(frozen=True)
class Outcome:
    """One outcome with its pictures.

    Args:
        record: the question and the truth.
        scene: the scene of the outcome.
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


def neutral_id(name: str, seed: int) -> str:
    """Random number for a named outcome; it reveals neither source nor truth."""
    return f"{np.random.default_rng([seed, *name.encode()]).integers(10**12):012d}"


def picture_paths(outcome: str, seen: Mapping[str, Mapping[str, np.ndarray]]) -> dict[str, dict[str, str]]:
    """Paths of the pictures of an outcome in its folder."""
    return {when: {camera: f"{outcome}/{when}-{camera}.png" for camera in shown} for when, shown in seen.items()}


def write_list(records: list[OutcomeRecord], folder: Path) -> None:
    """Write the records of a folder of outcomes: the questions and, in a file of its own, the truth."""
    OutcomeList(outcomes=[OutcomeQuestion(**_fields(record, OutcomeQuestion)) for record in records]).write(
        folder / LIST
    )
    truths = {record.id: OutcomeTruth(**_fields(record, OutcomeTruth)) for record in records}
    OutcomeTruths(truths=truths).write(folder / TRUTHS)
    (folder / "README.md").write_text(README, encoding="utf-8")


def _fields(record: Record, kind: type[Record]) -> dict[str, Any]:
    return {name: getattr(record, name) for name in kind.model_fields}


def read_outcomes(folder: Path) -> Iterator[Outcome]:
    """The outcomes of a folder, one at a time.

    Raises:
        InputFileError: the folder has no list of outcomes or of what is true of each, or lacks a file of one.
    """
    for needed in (folder / LIST, folder / TRUTHS):
        if not needed.exists():
            raise InputFileError(
                f"{needed} does not exist", hint="python -m benchmarks critic --keep DIR writes such a folder"
            )
    truths = OutcomeTruths.read(folder / TRUTHS).truths
    for question in OutcomeList.read(folder / LIST).outcomes:
        if question.id not in truths:
            raise InputFileError(
                f"{folder / TRUTHS} says nothing of {question.id}", hint=f"put back the file that came with {LIST}"
            )
        told = _fields(question, OutcomeQuestion) | _fields(truths[question.id], OutcomeTruth)
        record, scene = OutcomeRecord(**told), Scene.read(folder / question.scene)
        seen = {
            when: {camera: read_picture(folder / path) for camera, path in shown.items()}
            for when, shown in record.pictures.items()
        }
        yield Outcome(record, scene, seen, read_picture(folder / record.empty))
