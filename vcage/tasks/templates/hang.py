"""Hang: the closed handle of a thing is slid over a peg of a rack, where the thing stays."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import ClassVar

from vcage.base.geometry import Pose
from vcage.objects.pegs import loops_of, pegs_of
from vcage.schema.asset import ContactPoint
from vcage.sim.kinematics import ArmKinematics
from vcage.tasks.hanging import free_pegs, hanging_ways, leaves_free, suits
from vcage.tasks.primitives.grip import sag
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates.along_way import AlongTemplate, AlongWay


@dataclass(frozen=True)
class Hanging(AlongWay):
    """A thing, and its goal to hang on a rack."""

    done: ClassVar[str] = "hung-on"

    @property
    def where(self) -> str:
        """A peg of the rack."""
        return f"a peg of {self.target.record.phrase}"

    def too_many(self, number: int) -> str | None:
        """One thing hangs on each peg."""
        pegs = len(pegs_of(self.target.asset))
        if 0 < pegs < number:
            return f"{self.target.record.phrase} has {pegs} pegs, and {number} things are to hang on it"
        return None

    def misfit(self) -> str | None:
        """The thing must have a closed handle, and the rack a peg for it."""
        name, there = self.thing.record.phrase, self.target.record.phrase
        loops, pegs = loops_of(self.thing.asset), pegs_of(self.target.asset)
        if not loops:
            return f"{name} has no closed handle to hang it by"
        if not pegs:
            return f"{there} has no peg to hang something on"
        if not any(suits(loop, peg) for loop, peg in product(loops, pegs)):
            return f"the pegs of {there} are too thick for the handle of {name}"
        return None

    def unfit(self, others: Sequence[SceneObject]) -> str | None:
        """A peg that suits the thing must be free."""
        free = free_pegs(self.target, others)
        if any(suits(loop, peg) for loop, peg in product(loops_of(self.thing.asset), free)):
            return None
        return f"every peg of {self.target.record.phrase} is taken"

    def suitable(
        self, contact: ContactPoint, kinematics: Mapping[str, ArmKinematics]
    ) -> tuple[dict[str, ArmKinematics], str]:
        """The arms that hold the thing level and its handle free."""
        held, loops = f"held at {contact.name!r}, {self.thing.record.phrase}", loops_of(self.thing.asset)
        free = {
            arm: one
            for arm, one in kinematics.items()
            if any(leaves_free(contact, loop, one.arm.gripper) for loop in loops)
        }
        if not free:
            return free, f"{held} has fingers in its handle, through which the peg must pass"
        level = {arm: one for arm, one in free.items() if not sag(self.thing, contact, one.arm.gripper)}
        return level, f"{held} turns between the fingers"

    def ways(self, contact: ContactPoint, others: Sequence[SceneObject]) -> Iterable[Sequence[Pose]]:
        """Those on which the handle is slid over a free peg."""
        return hanging_ways(self.thing, self.target, others)


HANG = AlongTemplate("hang", "hung_on", Hanging)
