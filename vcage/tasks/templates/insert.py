"""Insert: the shaft of a thing, held behind its middle, is slid into a hole along its axis, and let go there."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import ClassVar

from vcage.base.geometry import Pose
from vcage.objects.holes import holes_of, shafts_of
from vcage.schema.asset import ContactPoint
from vcage.sim.kinematics import ArmKinematics
from vcage.tasks.inserting import free_holes, inserting_ways, suits
from vcage.tasks.primitives.grip import sag
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates.along_way import AlongTemplate, AlongWay


@dataclass(frozen=True)
class Inserting(AlongWay):
    """A thing, and its goal to be inserted in another one."""

    done: ClassVar[str] = "inserted-in"

    @property
    def where(self) -> str:
        """The hole."""
        return f"the hole of {self.target.record.phrase}"

    def too_many(self, number: int) -> str | None:
        """One thing goes into each hole."""
        holes = len(holes_of(self.target.asset))
        if 0 < holes < number:
            has = f"{self.target.record.phrase} has {holes} hole{'s' * (holes > 1)}"
            return f"{has}, and {number} things are to be inserted in it"
        return None

    def misfit(self) -> str | None:
        """The thing must have a shaft, and the other one a hole for it."""
        name, there = self.thing.record.phrase, self.target.record.phrase
        shafts, holes = shafts_of(self.thing.asset), holes_of(self.target.asset)
        if not shafts:
            return f"{name} is no peg that goes into a hole"
        if not holes:
            return f"{there} has no hole to insert something in"
        if not any(suits(shaft, hole) for shaft, hole in product(shafts, holes)):
            return f"{name} is too thick for the hole of {there}"
        return None

    def unfit(self, others: Sequence[SceneObject]) -> str | None:
        """A hole that the shaft goes into must be free."""
        free = free_holes(self.target, others)
        if any(suits(shaft, hole) for shaft, hole in product(shafts_of(self.thing.asset), free)):
            return None
        return f"every hole of {self.target.record.phrase} is taken"

    def suitable(
        self, contact: ContactPoint, kinematics: Mapping[str, ArmKinematics]
    ) -> tuple[dict[str, ArmKinematics], str]:
        """The arms that hold the thing level, with enough of it free to go in."""
        held = f"held at {contact.name!r}, {self.thing.record.phrase}"
        if not any(True for _ in inserting_ways(self.thing, self.target, contact, [])):
            return {}, f"{held} is too short to go into {self.where}"
        level = {arm: one for arm, one in kinematics.items() if not sag(self.thing, contact, one.arm.gripper)}
        return level, f"{held} turns between the fingers"

    def ways(self, contact: ContactPoint, others: Sequence[SceneObject]) -> Iterable[Sequence[Pose]]:
        """Those on which the shaft is slid into a free hole."""
        return inserting_ways(self.thing, self.target, contact, others)


INSERT = AlongTemplate("insert", "inserted_in", Inserting)
