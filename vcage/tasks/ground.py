"""Places to put things down on the table: anywhere, beside another, back where it stood, before the customer."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from vcage.base.attempts import LIMITS
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose, world_aabb
from vcage.goals.in_place_of import off_place
from vcage.goals.row_left_of import in_row
from vcage.goals.thresholds import THRESHOLDS
from vcage.layout.items import TableItem, table_item
from vcage.layout.placement.place import place
from vcage.plans.relations import BESIDE_GAP, DIRECTIONS, NEAR_GAP, holds
from vcage.schema.goals import Goal
from vcage.schema.scene import Scene
from vcage.sim.kinematics import ArmKinematics, kinematics_of
from vcage.sim.robots import load_robot
from vcage.tasks.hand_poses import hand_poses
from vcage.tasks.scene_objects import SceneObject

DIRECTIONS_OF_ARMS = {"left": -1, "right": 1}
"""Side of the table's middle, along x, on which an arm puts down an object that it was handed."""


FACING = {"presented": np.pi, "facing_robot": 0.0}
"""Heading of what faces the customer, or the robot."""


@dataclass(frozen=True)
class GroundSettings:
    """Room and distances of things that are put down on the table.

    Args:
        gap_m: around an object when put down.
        within_m: spare distance of a relation, as a released object may roll a little.
        reach_m: largest distance, between their edges, for putting an object to the left or right of another.
        sideways_m: how much farther to the side than the other's edges a thing may stand before it or beside it.
        centred_m: side of the square at the centre of the table for the middle of what is put down there.
        customer_side_m: depth of the customer's strip at the table's far side.
        ik_starts: starts of inverse kinematics for each place: they find 98 % of what all starts find on aloha_agilex
            and 91 % on dual_panda, and a hand has many ways to bring an object there.
    """

    gap_m: float = 0.02
    within_m: float = 0.015
    reach_m: float = 0.3
    sideways_m: float = 0.06
    centred_m: float = 0.1
    customer_side_m: float = 0.14
    ik_starts: int = 3


SETTINGS = GroundSettings()


Zone = tuple[np.ndarray, np.ndarray]
"""Lower and upper corner (2,) of a rectangle of the table, metres."""


@dataclass(frozen=True)
class Ground:
    """The part of the table that things may stand on.

    Args:
        lower, upper: (2,) its corners, metres.
        height: z of the table top, metres.
        arms: one of them must reach the object; without any it may stand anywhere.
        starts: boxes (2, 3) of the objects at the start, by id.
    """

    lower: np.ndarray
    upper: np.ndarray
    height: float
    arms: tuple[ArmKinematics, ...] = ()
    starts: Mapping[str, np.ndarray] = field(default_factory=dict)

    @classmethod
    def of(cls, scene: Scene) -> Ground:
        """Return the ground of a scene, with the arms of its robot."""
        arms = tuple(kinematics_of(arm) for arm in load_robot(scene.robot).arms.values())
        return cls(np.array(scene.workspace.lower), np.array(scene.workspace.upper), scene.table.height, arms)

    def poses(
        self,
        thing: SceneObject,
        goal: Goal,
        others: Sequence[SceneObject],
        rng: np.random.Generator,
        taken: Iterable[np.ndarray] = (),
    ) -> Iterator[Pose]:
        """Poses in the world at which a goal of a thing becomes true and it touches nothing: what lies is stood up.

        Args:
            thing: where it stood at the start.
            goal: whose subject it is: ``on`` the table, ``centred`` on it, ``presented``, ``back``, ``moved_away``,
                ``handed`` to the arm of one side, ``in_place_of`` a thing, or beside, left of… one.
            others: the other things, where they will be.
            rng: of all choices.
            taken: rectangles (2, 2) of the table to keep free besides.
        """
        if goal.relation == "back":
            yield thing.pose
            return
        if goal.relation == "in_place_of":
            yield from self._poses_in_place(thing, str(goal.reference), self.after_leaving(goal, others))
            return
        holds, rectangles = self._holds(thing), [*(_footprint(o) for o in others), *taken]
        near = next((o for o in others if o.id == goal.reference), None)
        for _ in range(LIMITS.ground_rounds):
            found = False
            for pose in self._free_poses(thing, goal, near, rectangles, rng):
                if self._reached(pose, holds):
                    found = True
                    yield pose
            if found:
                return

    def _free_poses(
        self,
        thing: SceneObject,
        goal: Goal,
        near: SceneObject | None,
        taken: Sequence[np.ndarray],
        rng: np.random.Generator,
    ) -> Iterator[Pose]:
        """Random poses at which a goal of a thing becomes true and it touches nothing; arms may not reach them."""
        standing, back = thing.as_standing, thing.asset.stands.inverse()
        for yaws in _yaws(standing, goal):
            item = replace(table_item(thing.id, standing.asset), yaws=yaws)
            for zone in self._zones(standing, goal, near, max(item.size[:2]), rng):
                for pose in self._poses_in(zone, item, taken, rng):
                    if near is None or _stands(goal, world_aabb(standing.asset.bounds, pose), near.aabb):
                        yield pose * back

    def after_leaving(self, goal: Goal, others: Sequence[SceneObject]) -> list[SceneObject]:
        """The other objects, without one that still stands in the place that a goal gives to another."""
        place = self.starts.get(str(goal.reference))
        if goal.relation != "in_place_of" or place is None:
            return list(others)
        return [o for o in others if o.id != goal.reference or off_place(o.aabb, place) > THRESHOLDS.swapped_m]

    def _poses_in_place(self, thing: SceneObject, stood: str, others: Sequence[SceneObject]) -> Iterator[Pose]:
        """Poses of an object in the middle of the place where another stood at the start."""
        holds, taken = self._holds(thing), [_footprint(o) for o in others]
        bounds, back = thing.as_standing.asset.bounds, thing.asset.stands.inverse()
        for yaw in dict.fromkeys(yaw for yaws in _quarters(thing) for yaw in yaws):
            box = world_aabb(bounds, Pose.from_yaw([0.0, 0.0, 0.0], yaw))
            middle = self.starts[stood].mean(axis=0) - box.mean(axis=0)
            pose = Pose.from_yaw([*middle[:2], self.height - box[0, 2]], yaw)
            room = world_aabb(bounds, pose)[:, :2] + np.array([[-SETTINGS.gap_m], [SETTINGS.gap_m]])
            met = any(np.all(room[0] < other[1]) and np.all(other[0] < room[1]) for other in taken)
            if not met and self._reached(pose * back, holds):
                yield pose * back

    def _poses_in(
        self, zone: Zone, item: TableItem, taken: Sequence[np.ndarray], rng: np.random.Generator
    ) -> Iterator[Pose]:
        """Poses of an item at random free places of a zone."""
        with contextlib.suppress(InfeasibleScene):  # another draw finds no room either
            for _ in range(LIMITS.zone_draws):
                found = place([item], np.stack(zone), rng, margin=SETTINGS.gap_m, obstacles=taken)
                yield item.pose(found[item.id], self.height)

    def _holds(self, thing: SceneObject) -> list[tuple[ArmKinematics, Pose]]:
        """The ways in which arms can take a thing where it stands: an arm, and its gripper in the thing's frame.

        Where there are none, the thing is reached by another way or not at all: all ways there are.
        """
        ways = [
            (arm, grasp)
            for arm in self.arms
            for contact in thing.asset.annotation.carrying_points
            for grasp in hand_poses(thing, contact, arm.arm.gripper)
        ]
        taken = [way for way in ways if way[0].reachable(way[1].pose, SETTINGS.ik_starts)]
        return [(arm, grasp.in_object) for arm, grasp in taken or ways]

    def _reached(self, pose: Pose, holds: Sequence[tuple[ArmKinematics, Pose]]) -> bool:
        """True if an arm brings a thing that it holds to a pose, and gets up again."""
        return not self.arms or any(
            all(
                arm.reachable(Pose(hand.p + [0, 0, up], hand.q), SETTINGS.ik_starts)
                for up in (0, arm.arm.gripper.approach)
            )
            for arm, hand in ((arm, pose * held) for arm, held in holds)
        )

    def _zones(
        self, thing: SceneObject, goal: Goal, near: SceneObject | None, size: float, rng: np.random.Generator
    ) -> Iterator[Zone]:
        """Lower and upper corners of the target rectangles for the object, in the order to try them."""
        if near is None or goal.relation == "presented":
            yield from self._zones_of_table(thing, goal, size)
        elif goal.relation == "row_left_of":
            (left, y, _), half = near.aabb.mean(axis=0) - [np.ptp(near.aabb[:, 0]) / 2, 0, 0], size / 2
            deep = half + THRESHOLDS.row_off_m - SETTINGS.within_m
            zone = [[left - size - THRESHOLDS.row_gap_m + SETTINGS.within_m, y - deep], [left, y + deep]]
            yield from self._within_table(np.array(zone))
        else:
            words = [goal.relation] if goal.relation in DIRECTIONS else list(rng.permutation(list(DIRECTIONS)))
            reach = {"beside": BESIDE_GAP, "near": NEAR_GAP}.get(goal.relation, SETTINGS.reach_m)
            for word in words:
                zone = _side(near.aabb[:, :2], np.array(DIRECTIONS[word]), reach - SETTINGS.within_m + size)
                yield from self._within_table(zone)

    def _zones_of_table(self, thing: SceneObject, goal: Goal, size: float) -> Iterator[Zone]:
        """The zones of a goal that names no other thing."""
        if goal.relation == "presented":
            for depth in (SETTINGS.customer_side_m, self.upper[1]):  # where it is full, anywhere on the customer's half
                yield np.array([self.lower[0], self.upper[1] - depth]), self.upper
            # and where arms are short, the near part of that
            yield np.array([self.lower[0], 0.0]), np.array([self.upper[0], self.upper[1] / 2])
        elif goal.relation == "handed" and goal.reference in DIRECTIONS_OF_ARMS:
            sign, middle = DIRECTIONS_OF_ARMS[goal.reference], (self.lower[0] + self.upper[0]) / 2
            yield (
                np.array([middle if sign > 0 else self.lower[0], self.lower[1]]),
                np.array([self.upper[0] if sign > 0 else middle, self.upper[1]]),
            )
        elif goal.relation == "centred":
            half = (SETTINGS.centred_m + size) / 2
            yield from self._within_table(np.array([[-half, -half], [half, half]]))
        elif goal.relation == "moved_away":
            out = THRESHOLDS.away_m + SETTINGS.within_m - size / 2
            x, zone = thing.pose.p[0], np.stack([self.lower, self.upper])
            zone[(1, 0) if x < 0 else (0, 0)] = x - out if x < 0 else x + out
            yield from self._within_table(zone)
        else:
            yield self.lower, self.upper

    def _within_table(self, zone: np.ndarray) -> Iterator[Zone]:
        """The part of a zone (2, 2) that is on the table; nothing where there is none."""
        lower, upper = np.maximum(zone[0], self.lower), np.minimum(zone[1], self.upper)
        if np.all(lower < upper):
            yield lower, upper


def _stands(goal: Goal, box: np.ndarray, other: np.ndarray) -> bool:
    """True where a goal of places holds between two world boxes (2, 3)."""
    if goal.relation == "row_left_of":
        return in_row(box, other, SETTINGS.within_m)
    return holds(goal.relation, box, other)  # pyrefly: ignore[bad-argument-type]


def _yaws(thing: SceneObject, goal: Goal) -> list[tuple[float, ...]]:
    """Headings to try in turn: the later ones where no arm reaches the thing with those before."""
    if goal.relation in FACING:
        return [tuple(FACING[goal.relation] + np.radians(off)) for off in ([0, -10, 10], [-20, 20])]
    return _quarters(thing)


def _quarters(thing: SceneObject) -> list[tuple[float, ...]]:
    """Headings by quarters from a thing's own, and along the table's edges, where a box needs least room."""
    quarters = np.radians([0, 90, 180, 270])
    return [tuple(thing.pose.yaw + quarters), tuple(quarters)]


def _side(box: np.ndarray, direction: np.ndarray, depth: float) -> np.ndarray:
    """(2, 2) the rectangle beside a box (2, 2) on one side, as wide as the box and a little more."""
    across = np.abs(direction[::-1]) * SETTINGS.sideways_m
    zone = box + np.stack([-across, across])
    along = int(np.argmax(np.abs(direction)))
    zone[:, along] = (
        (box[1, along], box[1, along] + depth) if direction[along] > 0 else (box[0, along] - depth, box[0, along])
    )
    return zone


def _footprint(thing: SceneObject) -> np.ndarray:
    """(2, 2) rectangle that an object covers, with the sweep of its moving parts."""
    item = table_item(thing.id, thing.asset)
    half, centre = np.array(item.size[:2]) / 2, np.array(item.centre)
    bounds = np.array([[*(centre - half), 0.0], [*(centre + half), item.size[2]]])
    return world_aabb(bounds, thing.pose)[:, :2]
