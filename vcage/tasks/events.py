"""Watch a world for events: presses, codes that are read, objects that lie on a scale or change hands."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

import numpy as np

from vcage.goals.kind import Stated
from vcage.schema.goals import Goal
from vcage.sim.joints import joint_index
from vcage.sim.world import PHYSICS_HZ, World
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import WatchedState

LOOK_EVERY_STEPS = 10
"""Physics steps between two looks at contacts and codes."""

LOOK_EVERY_S = LOOK_EVERY_STEPS / PHYSICS_HZ


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
        self._events = {goal: _Event(goal) for goal in goals if goal.kind.happens is not None}
        self._before = world.object_poses()
        self._state = WatchedState(_Now(self), self)
        self.began = {name: self.now(name) for name in objects}
        self._handled = handled
        self.hands: list[str] = []
        world.before_step.append(self._note)

    def stop(self) -> None:
        """Follow it no more."""
        self.world.before_step.remove(self._note)

    def furthest_share(self, thing: SceneObject, part: str) -> float:
        """Position of a part where it was farthest from rest, as a share of its range: a pressed button comes back."""
        model = thing.asset.model
        index = joint_index(model, part)
        return float(self._furthest[thing.id][index]) / abs(model.links[index].joint.far_end)

    def lasted_s(self, goal: Stated) -> float:
        """For how long an event that was waited for went on at most."""
        return self._events[goal].longest * LOOK_EVERY_S  # pyrefly: ignore[bad-index]

    def speed_m_per_s(self, name: str) -> float:
        """Speed of an object since the last look."""
        return float(np.linalg.norm(self.world.object_pose(name).p - self._before[name].p)) / LOOK_EVERY_S

    def now(self, object_id: str) -> SceneObject:
        """An object as it stands now."""
        body = self.world.body(object_id)
        return self.objects[object_id].moved(body.pose, body.joints)

    def _note(self, world: World) -> None:
        for name, joints in world.joints_of_objects().items():
            self._furthest[name] = np.maximum(self._furthest[name], np.abs(joints))
        if world.steps % LOOK_EVERY_STEPS:
            return
        if self._handled is not None:
            touching = self._state.touching(self._handled) & {*world.arms}
            self.hands += sorted(touching - {*self.hands})
        if self._events:
            for event in self._events.values():
                event.look(self._state)
            self._before = world.object_poses()


class _Event:
    """Counts for how many looks the event of a goal goes on.

    Args:
        goal: of a kind with an event.
    """

    def __init__(self, goal: Goal):
        self._goal = goal
        self._notes: set[str] = set()
        self._going = self.longest = 0

    def look(self, state: WatchedState) -> None:
        happens = self._goal.kind.happens
        now = happens is not None and happens(self._goal, state, self._notes)
        self._going = self._going + 1 if now else 0
        self.longest = max(self.longest, self._going)


class _Now(Mapping[str, SceneObject]):
    """The objects of a watch as they stand when they are asked for."""

    def __init__(self, watch: Watch):
        self._watch = watch

    def __getitem__(self, name: str) -> SceneObject:
        if name not in self._watch.objects:
            raise KeyError(name)
        return self._watch.now(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._watch.objects)

    def __len__(self) -> int:
        return len(self._watch.objects)
