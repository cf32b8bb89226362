"""The simulator's state as a kind of goal asks for it: see :class:`vcage.goals.kind.State`."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vcage.goals.kind import Stated
from vcage.goals.thresholds import THRESHOLDS
from vcage.plans.relations import holds
from vcage.schema.asset import FunctionalPoint
from vcage.schema.plan import TABLE
from vcage.sim.joints import joint_index, joint_positions
from vcage.tasks.reading import reads
from vcage.tasks.scene_objects import SceneObject

if TYPE_CHECKING:
    from vcage.tasks.events import Watch


@dataclass(frozen=True)
class WatchedState:
    """Implements :class:`vcage.goals.kind.State`.

    Args:
        objects: by id, as they are now.
        seen: watches the world; None where only poses and joints are asked for.
    """

    objects: Mapping[str, SceneObject]
    seen: Watch | None = None

    @property
    def watch(self) -> Watch:
        """The watch of the world.

        Raises:
            ValueError: nothing watches it.
        """
        if self.seen is None:
            raise ValueError("what happens in a world is told by a watch of it, and there is none")
        return self.seen

    @property
    def arms(self) -> Collection[str]:
        """Names of the robot's arms."""
        return self.watch.world.arms

    @property
    def table_height(self) -> float:
        """z of the table top, metres."""
        return self.watch.world.table.height

    def thing(self, name: str) -> SceneObject:
        """An object as it stands now."""
        return self.objects[name]

    def at_start(self, name: str) -> SceneObject:
        """An object as it stood at the start of the episode."""
        return self.watch.objects[name]

    def touching(self, name: str) -> set[str]:
        """Ids of objects, names of arms, and ``table``, that press on an object."""
        return {other.partition("/")[0] for other in self.watch.world.touching(name)}

    def holds(self, arm: str, name: str) -> bool:
        """True where all fingers of an arm press on an object."""
        return self.watch.world.holds(arm, name)

    def speed_m_per_s(self, name: str) -> float:
        """Speed of an object since the last look."""
        return self.watch.speed_m_per_s(name)

    def share(self, name: str, part: str) -> float:
        """Position of a moving part, as a share of its range from rest."""
        thing = self.objects[name]
        model = thing.asset.model
        index = joint_index(model, part)
        return float(joint_positions(model, thing.joints)[index]) / model.links[index].joint.far_end

    def furthest_share(self, name: str, part: str) -> float:
        """The same where it was farthest from rest."""
        return self.watch.furthest_share(self.objects[name], part)

    def lasted_s(self, goal: Stated) -> float:
        """Longest time that the event of a goal went on without a break."""
        return self.watch.lasted_s(goal)

    def weighs(self, name: str) -> bool:
        """True where a name is that of a scale."""
        return name in self.objects and any(p.weighs for p in self.objects[name].asset.annotation.functional_points)

    def is_read(self, name: str) -> bool:
        """True where the window of a scanner reads a bar code of an object."""
        return any(reads(self.objects[other], self.objects[name]) for other in self.objects if other != name)

    def stands(self, goal: Stated) -> bool:
        """True where the geometry of the goal's relation word holds between the boxes of its two objects."""
        subject, reference = self.objects[goal.subject], self._reference(goal)
        return holds(goal.relation, subject.aabb, reference.aabb)  # pyrefly: ignore[bad-argument-type]

    def not_resting(self, goal: Stated) -> str | None:
        """Why the subject does not rest in or on the reference; None where it does."""
        thing, receptacle, inside = self.objects[goal.subject], self._reference(goal), goal.relation == "inside"
        points = [
            point for point in receptacle.asset.annotation.functional_points
            if point.link == goal.part and (point.holds == "in") == inside
        ]  # fmt: skip
        found = [place_complaint(thing, receptacle, point) for point in points]
        if None not in found:
            return next(iter(found), f"nothing is put {goal.relation} {receptacle.id}")
        share = 0.0 if self.seen is None else self.seen.world.borne_by(thing.id).get(TABLE, 0.0)
        return f"the table bears {100 * share:.0f} % of {thing.id}" if share > THRESHOLDS.borne_share else None

    def _reference(self, goal: Stated) -> SceneObject:
        """The object that a goal refers to.

        Raises:
            ValueError: it refers to none.
        """
        if goal.reference not in self.objects:
            raise ValueError(f"no ground truth is defined for {str(goal)!r}")
        return self.objects[goal.reference]


def resting_point(subject: SceneObject, receptacle: SceneObject) -> FunctionalPoint | None:
    """The functional point of a receptacle that an object rests at; None where it rests at none."""
    points = receptacle.asset.annotation.functional_points
    return next((point for point in points if place_complaint(subject, receptacle, point) is None), None)


def place_complaint(subject: SceneObject, receptacle: SceneObject, point: FunctionalPoint) -> str | None:
    """Why an object does not rest at a functional point, or None when it does."""
    opening = receptacle.asset.opening(point)
    frame = receptacle.frame(point.id)
    local = frame.inverse().apply(subject.aabb.mean(axis=0))
    outside = np.abs(local[:2] - opening.centre) - np.asarray(opening.size) / 2
    if np.any(outside > THRESHOLDS.edge_m):
        return f"{subject.id} is {100 * outside.max():.1f} cm outside {receptacle.id}"
    floor = frame.apply([*opening.centre, opening.floor])[2]
    above = subject.lowest - floor
    limit = max(THRESHOLDS.height_m, opening.depth - THRESHOLDS.rim_m)
    if not -THRESHOLDS.height_m <= above <= limit:
        return f"{subject.id} is {100 * above:.1f} cm above the floor of {receptacle.id}"
    if receptacle.pose.rotation()[2, 2] < np.cos(THRESHOLDS.upright_rad):
        return f"{receptacle.id} is tipped"
    return None
