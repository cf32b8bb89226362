"""The simulator's state as a kind of goal asks for it (:class:`vcage.goals.kind.State`), still or watched.

A watch follows a world for events: presses, codes that are read, objects that lie on a scale or change hands.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

import numpy as np

from vcage.goals.kind import Inserted, Stated
from vcage.goals.thresholds import THRESHOLDS
from vcage.plans.relations import holds
from vcage.schema.asset import FunctionalPoint
from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE
from vcage.sim.joints import joint_index, joint_positions
from vcage.sim.world import PHYSICS_HZ, World
from vcage.tasks.hanging import hangs_on
from vcage.tasks.hitting import hits
from vcage.tasks.inserting import inserted
from vcage.tasks.reading import reads
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.wiping import cells_of, under_pad


class StillState:
    """The part of :class:`vcage.goals.kind.State` that poses and joints tell; a watch tells all.

    Args:
        objects: by id, as they are.
    """

    def __init__(self, objects: Mapping[str, SceneObject]):
        self.objects = objects

    def thing(self, name: str) -> SceneObject:
        """An object as it stands now."""
        return self.objects[name].as_standing

    def share(self, name: str, part: str) -> float:
        """Position of a moving part, as a share of its range from rest."""
        thing = self.thing(name)
        model = thing.asset.model
        index = joint_index(model, part)
        return float(joint_positions(model, thing.joints)[index]) / model.links[index].joint.far_end

    def table_share(self, name: str) -> float:
        """Share of an object's weight that the table bears; 0 where no world tells."""
        return 0.0

    def hangs_on(self, name: str, rack: str) -> bool:
        """True where a peg of a rack passes through the closed handle of an object."""
        return hangs_on(self.thing(name), self.thing(rack))

    def inserted(self, name: str, place: str) -> Inserted | None:
        """How the shaft of an object lies in a hole of a place; None where one has none."""
        return inserted(self.thing(name), self.thing(place))

    def weighs(self, name: str) -> bool:
        """True where a name is that of a scale."""
        return name in self.objects and any(p.weighs for p in self.objects[name].asset.annotation.functional_points)

    def is_read(self, name: str) -> bool:
        """True where the window of a scanner reads a bar code of an object."""
        return any(reads(self.thing(other), self.thing(name)) for other in self.objects if other != name)

    def stands(self, goal: Stated) -> bool:
        """True where the geometry of the goal's relation word holds between the boxes of its two objects."""
        subject, reference = self.thing(goal.subject), self._reference(goal)
        return holds(goal.relation, subject.aabb, reference.aabb)  # pyrefly: ignore[bad-argument-type]

    def not_resting(self, goal: Stated) -> str | None:
        """Why the subject does not rest in or on the reference; None where it does."""
        thing, receptacle, inside = self.thing(goal.subject), self._reference(goal), goal.relation == "inside"
        points = [
            point for point in receptacle.asset.annotation.functional_points
            if point.is_of(goal.part) and (point.holds == "in") == inside
        ]  # fmt: skip
        found = [place_complaint(thing, receptacle, point) for point in points]
        if None not in found:
            return next(iter(found), f"nothing is put {goal.relation} {receptacle.id}")
        share = self.table_share(thing.id)
        return f"the table bears {100 * share:.0f} % of {thing.id}" if share > THRESHOLDS.borne_share else None

    def _reference(self, goal: Stated) -> SceneObject:
        """The object that a goal refers to.

        Raises:
            ValueError: it refers to none.
        """
        if goal.reference not in self.objects:
            raise ValueError(f"no ground truth is defined for {str(goal)!r}")
        return self.thing(goal.reference)


def resting_point(subject: SceneObject, receptacle: SceneObject) -> FunctionalPoint | None:
    """The functional point of a receptacle that an object rests at; None where it rests at none."""
    points = receptacle.asset.annotation.functional_points
    return next((point for point in points if place_complaint(subject, receptacle, point) is None), None)


def lying_on(receptacle: SceneObject, others: Iterable[SceneObject]) -> list[SceneObject]:
    """The objects among others that rest in or on a receptacle."""
    # a flat thing under it is within the tolerance of lying on it
    return [o for o in others if o.lowest > receptacle.lowest and resting_point(o, receptacle) is not None]


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


LOOK_EVERY_STEPS = 10
"""Physics steps between two looks at contacts and codes."""

LOOK_EVERY_S = LOOK_EVERY_STEPS / PHYSICS_HZ


class Watch(StillState):
    """Follows a world while it goes on; implements :class:`vcage.goals.kind.State`.

    Args:
        world: that is watched, from now on.
        objects: by id, as they stood at the start of the episode.
        goals: events that are waited for.
        handled: id of an object; the arms that touch it are noted.

    Attributes:
        world: that is watched.
        objects: as given.
        began: the objects at the start of the watch, by id.
        hands: the arms that touched ``handled``, in the order of their first touch.
    """

    def __init__(
        self,
        world: World,
        objects: Mapping[str, SceneObject],
        goals: Collection[Goal] = (),
        handled: str | None = None,
    ):
        super().__init__(objects)
        self.world = world
        self._furthest = {name: np.abs(joints) for name, joints in world.joints_of_objects().items()}
        self._events = {goal: _Event(goal) for goal in goals if goal.kind.happens is not None}
        self._before = world.object_poses()
        self.began = {name: self.thing(name) for name in objects}
        self._handled = handled
        self.hands: list[str] = []
        world.before_step.append(self._note)

    def stop(self) -> None:
        """Stop following it."""
        self.world.before_step.remove(self._note)

    @property
    def arms(self) -> Collection[str]:
        """Names of the robot's arms."""
        return self.world.arms

    @property
    def table_height(self) -> float:
        """z of the table top, metres."""
        return self.world.table.height

    def thing(self, name: str) -> SceneObject:
        """An object as it stands now."""
        body = self.world.body(name)
        return self.objects[name].moved(body.pose, body.joints).as_standing

    def at_start(self, name: str) -> SceneObject:
        """An object as it stood at the start of the episode."""
        return self.objects[name].as_standing

    def touching(self, name: str) -> set[str]:
        """Ids of objects, names of arms, and ``table``, that press on an object."""
        return {other.partition("/")[0] for other in self.world.touching(name)}

    def is_hit(self, name: str) -> bool:
        """True where the head of a tool in a hand presses on the middle of an object's top."""
        return any(hits(self.thing(tool), self.thing(name)) for tool in self._tools_on(name))

    def wiping(self, name: str) -> tuple[Collection[int], int]:
        """Numbers of the cells of an object's flat top that the pad of a tool in a hand wipes now; and of all cells."""
        thing = self.thing(name)
        sliding = [self.thing(tool) for tool in self._tools_on(name) if self._slides(tool, name)]
        return {cell for tool in sliding for cell in under_pad(tool, thing).tolist()}, len(cells_of(thing))

    def _slides(self, tool: str, thing: str) -> bool:
        """True where a tool moves along the top of an object since the last look."""
        before = self._before[thing].inverse().apply(self._before[tool].p)
        now = self.thing(thing).pose.inverse().apply(self.thing(tool).pose.p)
        return float(np.linalg.norm((now - before)[:2])) >= THRESHOLDS.wiped_m_per_s * LOOK_EVERY_S

    def _tools_on(self, name: str) -> list[str]:
        """Ids of the objects between the fingers of an arm that press on an object."""
        touching = self.touching(name) & self.objects.keys()
        return [tool for tool in touching if any(self.holds(arm, tool) for arm in self.arms)]

    def contents(self, name: str) -> Collection[str]:
        """Ids of the objects that lay in an object when the watch began."""
        return [o.id for o in lying_on(self.began[name], [o for o in self.began.values() if o.id != name])]

    def lies_in(self, name: str, other: str) -> bool:
        """True where an object rests in another, and not on its bare top."""
        point = resting_point(self.thing(name), self.thing(other))
        return point is not None and point.holds == "in" and self.table_share(name) <= THRESHOLDS.borne_share

    def at_rest(self, name: str) -> bool:
        """True if an object hardly moves now."""
        return self.world.at_rest(name)

    def holds(self, arm: str, name: str) -> bool:
        """True where all fingers of an arm press on an object."""
        return self.world.holds(arm, name)

    def table_share(self, name: str) -> float:
        """Share of an object's weight that the table bears."""
        return self.world.borne_by(name).get(TABLE, 0.0)

    def furthest_share(self, name: str, part: str) -> float:
        """Position of a part where it was farthest from rest, as a share of its range: a pressed button comes back."""
        model = self.objects[name].asset.model
        index = joint_index(model, part)
        return float(self._furthest[name][index]) / abs(model.links[index].joint.far_end)

    def lasted_s(self, goal: Stated) -> float:
        """Longest duration of a watched event, seconds."""
        return self._events[goal].longest * LOOK_EVERY_S  # pyrefly: ignore[bad-index]

    def speed_m_per_s(self, name: str) -> float:
        """Speed of an object since the last look."""
        return float(np.linalg.norm(self.world.object_pose(name).p - self._before[name].p)) / LOOK_EVERY_S

    def _note(self, world: World) -> None:
        for name, joints in world.joints_of_objects().items():
            self._furthest[name] = np.maximum(self._furthest[name], np.abs(joints))
        if world.steps % LOOK_EVERY_STEPS:
            return
        if self._handled is not None:
            touching = self.touching(self._handled) & {*world.arms}
            self.hands += sorted(touching - {*self.hands})
        if self._events:
            for event in self._events.values():
                event.look(self)
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

    def look(self, state: Watch) -> None:
        happens = self._goal.kind.happens
        now = happens is not None and happens(self._goal, state, self._notes)
        self._going = self._going + 1 if now else 0
        self.longest = max(self.longest, self._going)
