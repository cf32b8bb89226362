"""Failures planted in attempts: when one happens, and its effect on the object set down."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from vcage.base.geometry import Pose
from vcage.schema.episodes import Failure
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Subtask
from vcage.tasks.ground import Ground
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import Slot

Kind = Literal["chance", "causes"]


class Planted(Protocol):
    """Says of each attempt whether it is to fail, and how."""

    def failure(self, subtask: Subtask, grasp: tuple[int | None, str | None], slot: Slot | None) -> Failure | None:
        """Return the planted failure of an attempt; None lets it succeed.

        Args:
            subtask: that was attempted.
            grasp: contact point and arm that it took.
            slot: that it took.
        """
        ...


@dataclass(frozen=True)
class Chance:
    """A share of the attempts succeeds; the others lose their object under any choice.

    Args:
        share: that succeeds.
        rng: that decides.
    """

    share: float
    rng: np.random.Generator

    def failure(self, subtask: Subtask, grasp: tuple[int | None, str | None], slot: Slot | None) -> Failure | None:
        """Return the planted failure, see :class:`Planted`."""
        return "lost" if self.rng.random() >= self.share else None


@dataclass(frozen=True)
class Causes:
    """A share of the grasps, and of the slots, is good for a step; the others are bad each time that they are taken.

    A bad grasp loses its object; an object in a bad slot does not stay there.

    Args:
        share: of each that is good.
        seed: of the episode; which are bad differs from step to step, and stays the same within one.
    """

    share: float
    seed: int

    def failure(self, subtask: Subtask, grasp: tuple[int | None, str | None], slot: Slot | None) -> Failure | None:
        """Return the planted failure, see :class:`Planted`."""
        if grasp in self.bad_grasps(subtask):
            return "lost"
        if slot is not None and self._bad(f"{subtask.id} slot {np.round(1000 * slot.pose.p).astype(int).tolist()}"):
            return "astray"
        return None

    def bad_grasps(self, subtask: Subtask) -> list[tuple[int, str]]:
        """(Contact point, arm) of grasps that lose their object; one of a step's grasps is always good."""
        grasps = sorted((g.contact, g.arm) for g in subtask.grasps)
        bad = [grasp for grasp in grasps if self._bad(f"{subtask.id} grasp {grasp}")]
        return bad[1:] if len(bad) == len(grasps) else bad

    def _bad(self, choice: str) -> bool:
        return np.random.default_rng([self.seed, *choice.encode()]).random() >= self.share


def befallen(
    failure: Failure,
    subtask: Subtask,
    objects: dict[str, SceneObject],
    was: Pose,
    ground: Ground,
    rng: np.random.Generator,
) -> Pose:
    """Pose of an object after a failure, in the world: it falls on the table from there.

    Args:
        failure: lost: near where it was, turned; astray: beside what was to receive it, else as if it were lost.
        subtask: that failed.
        objects: as they stand, by id.
        was: where it stood before.
        ground: of the table.
        rng: of all choices.
    """
    thing = objects[subtask.object].moved(was)
    if failure == "astray":
        beside = Goal(subject=thing.id, relation="beside", reference=subtask.receptacle)
        others = [one for key, one in objects.items() if key != thing.id]
        for pose in ground.poses(thing, beside, others, rng):
            return pose
    turn = Pose.from_yaw([0, 0, 0], float(rng.uniform(0.3, np.pi)))
    return Pose(was.p + [*rng.uniform(-0.02, 0.02, 2), 0.02], (turn * Pose(q=was.q)).q)
