"""Watches a world for what happens in it: presses, codes that are read, things that lie on a scale or change hands."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from vcage.plans.thresholds import THRESHOLDS
from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE
from vcage.sim.joints import joint_index
from vcage.sim.world import PHYSICS_HZ, World
from vcage.tasks.reading import reads
from vcage.tasks.scene_objects import SceneObject

EVERY = 10
"""Physics steps between two looks at contacts and codes."""

LASTS = {"weighed": THRESHOLDS.weighed_s, "scanned": THRESHOLDS.scanned_s, "handed": THRESHOLDS.handed_s}
"""How long an event must go on without a break, seconds."""


class Watch:
    """Follows a world while it goes on.

    Args:
        world: that is watched, from now on.
        objects: by id, as they stood at the start of the episode.
        goals: events that are waited for.
        handled: id of an object; the arms that touch it are noted.

    Attributes:
        world: that is watched.
        objects: as given.
        began: the objects when the watch began, by id.
        hands: the arms that touched ``handled``, in the order in which they first did.
    """

    def __init__(
        self,
        world: World,
        objects: Mapping[str, SceneObject],
        goals: Collection[Goal] = (),
        handled: str | None = None,
    ):
        self.world = world
        self.objects = objects
        self._furthest = {name: np.abs(joints) for name, joints in world.joints_of_objects().items()}
        self._goals = [goal for goal in goals if goal.relation in LASTS]
        self._going = dict.fromkeys(self._goals, 0)
        self._longest = dict.fromkeys(self._goals, 0)
        self._before = world.object_poses()
        self.began = {name: self.now(name) for name in objects}
        self._given: set[Goal] = set()
        self._handled = handled
        self.hands: list[str] = []
        world.before_step.append(self._note)

    def stop(self) -> None:
        """Follow it no more."""
        self.world.before_step.remove(self._note)

    def furthest(self, thing: SceneObject, part: str) -> float:
        """How far from rest a part was at most, as a share of its range: what was pressed comes back."""
        model = thing.asset.model
        index = joint_index(model, part)
        return float(self._furthest[thing.id][index]) / abs(model.links[index].joint.far_end)

    def lasted(self, goal: Goal) -> float:
        """For how long an event that was waited for went on at most, seconds."""
        return self._longest[goal] * EVERY / PHYSICS_HZ

    def now(self, object_id: str) -> SceneObject:
        """An object as it stands now."""
        body = self.world.body(object_id)
        return self.objects[object_id].moved(body.pose, body.joints)

    def _note(self, world: World) -> None:
        for name, joints in world.joints_of_objects().items():
            self._furthest[name] = np.maximum(self._furthest[name], np.abs(joints))
        if world.steps % EVERY:
            return
        if self._handled is not None:
            touching = {name.partition("/")[0] for name in world.touching(self._handled)} & {*world.arms}
            self.hands += sorted(touching - {*self.hands})
        if not self._goals:
            return
        for goal in self._goals:
            self._going[goal] = self._going[goal] + 1 if self._happens(goal) else 0
            self._longest[goal] = max(self._longest[goal], self._going[goal])
        self._before = world.object_poses()

    def _happens(self, goal: Goal) -> bool:
        if goal.relation == "handed":
            return self._is_handed(goal)
        return self._is_weighed(goal.subject) if goal.relation == "weighed" else self._is_scanned(goal.subject)

    def _is_handed(self, goal: Goal) -> bool:
        """Whether the arm alone holds what another held alone, and nothing but hands has touched it since."""
        holders = {name.partition("/")[0] for name in self.world.touching(goal.subject)}
        if not holders or not holders <= set(self.world.arms):
            self._given.discard(goal)
            return False
        if len(holders) > 1:
            return False
        (arm,) = holders
        held = self.world.holds(arm, goal.subject)
        if held and arm != goal.reference:
            self._given.add(goal)
        return held and arm == goal.reference and goal in self._given

    def _is_weighed(self, name: str) -> bool:
        """Whether it lies still on a scale, and nothing else does."""
        moved = np.linalg.norm(self.world.object_pose(name).p - self._before[name].p)
        if moved > THRESHOLDS.still_m_per_s * EVERY / PHYSICS_HZ:
            return False
        bearers = self.world.touching(name)
        if len(bearers) != 1:
            return False
        (scale,) = bearers
        weighs = scale in self.objects and any(p.weighs for p in self.objects[scale].asset.annotation.functional_points)
        return weighs and self.world.touching(scale) <= {name, TABLE}

    def _is_scanned(self, name: str) -> bool:
        return any(reads(self.now(other), self.now(name)) for other in self.objects if other != name)
