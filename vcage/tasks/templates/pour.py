"""Pour: a vessel is tipped over a container until all the balls in it lie in that, and put back."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.goals.thresholds import THRESHOLDS
from vcage.schema.asset import ContactPoint
from vcage.sim.kinematics import ArmKinematics
from vcage.tasks.pouring import balls_in, lips, pouring_ways
from vcage.tasks.primitives.grip import holds_firmly
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import lying_on
from vcage.tasks.stowing import heaped_in, open_point
from vcage.tasks.templates.along_way import AlongTemplate, AlongWay


@dataclass(frozen=True)
class Pouring(AlongWay):
    """A vessel, and its goal to be poured into a container."""

    done: ClassVar[str] = "poured-into"

    @property
    def where(self) -> str:
        """The vessel's place over the container."""
        return f"its place over {self.target.record.phrase}, tipped"

    def misfit(self) -> str | None:
        """The vessel must be open at the top and held beside its lip, the container wide open at the top."""
        phrase, there = self.thing.record.phrase, self.target.record.phrase
        if open_point(self.thing.asset) is None:
            return f"{phrase} is no vessel: nothing lies in it that could be poured"
        if not any(lips(self.thing, contact) for contact in self.thing.asset.annotation.carrying_points):
            return f"{phrase} is only held where its contents would roll over the fingers"
        point = open_point(self.target.asset)
        if point is None:
            return f"{there} is not open at the top: nothing is poured into it"
        size = self.target.asset.opening(point).size
        if min(size) < THRESHOLDS.poured_into_m:
            room = f"{100 * size[0]:.1f} × {100 * size[1]:.1f} cm"
            return f"{there} is too narrow to pour into: {room}, and {100 * THRESHOLDS.poured_into_m:.0f} cm are needed"
        return None

    def unfit(self, others: Sequence[SceneObject]) -> str | None:
        """All that lies in the vessel must be balls, for which an empty, upright container has room."""
        vessel, target = self.thing, self.target
        name, there = vessel.record.phrase, target.record.phrase
        contents = lying_on(vessel, others)
        strange = [o for o in contents if o.asset.ball_radius is None]
        if not contents:
            return f"nothing lies in {name} that could be poured"
        if strange:
            return f"{strange[0].record.phrase} lies in {name}, and only balls are poured"
        if there_already := lying_on(target, others):
            return f"{there_already[0].record.phrase} lies in {there}, and things are poured into what is empty"
        if target.pose.rotation()[2, 2] < np.cos(THRESHOLDS.upright_rad):
            return f"{there} is tipped"
        try:
            heaped_in(target, balls_in(vessel, others), np.random.default_rng(0))
        except InfeasibleScene as error:
            return error.message
        return None

    def suitable(
        self, contact: ContactPoint, kinematics: Mapping[str, ArmKinematics]
    ) -> tuple[dict[str, ArmKinematics], str]:
        """The arms that hold the vessel firmly."""
        width = self.thing.asset.grasp_width(contact)
        firm = {arm: one for arm, one in kinematics.items() if holds_firmly(one.arm.gripper, width)}
        return firm, f"held at {contact.name!r}, {self.thing.record.phrase} turns between fingers that are not firm"

    def ways(self, contact: ContactPoint, others: Sequence[SceneObject]) -> Iterable[Sequence[Pose]]:
        """Those on which the vessel is tipped over the container."""
        return pouring_ways(self.thing, self.target, contact)

    def around(self, others: Sequence[SceneObject]) -> tuple[SceneObject, ...]:
        """All but the contents of the vessel."""
        contents = lying_on(self.thing, others)
        return tuple(o for o in others if o not in contents)


POUR = AlongTemplate("pour", "poured", Pouring)
