"""Where on the table a thing is put down: anywhere, beside another, back where it stood, or before the customer."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose, world_aabb
from vcage.layout.items import table_item
from vcage.layout.placement.place import place
from vcage.plans.relations import BESIDE_GAP, DIRECTIONS, NEAR_GAP, holds
from vcage.plans.thresholds import THRESHOLDS
from vcage.schema.goals import Goal
from vcage.schema.scene import Scene
from vcage.sim.kinematics import ArmKinematics, kinematics_of
from vcage.sim.robots import load_robot
from vcage.tasks.grasps import grasp_poses
from vcage.tasks.scene_objects import SceneObject

GAP = 0.02
"""Room that is kept around what is put down, metres."""

WITHIN = 0.015
"""So much nearer than a relation allows, metres: what is let go may roll a little."""

REACH = 0.3
"""How far from another a thing is put to its left or right, metres: at most, between their edges."""

SIDEWAYS = 0.06
"""How much farther to the side than the other's edges a thing may stand that is put before it or beside it, metres."""

CUSTOMER_SIDE = 0.14
"""Depth of the strip at the table's far side that is the customer's, metres."""

TOWARDS_CUSTOMER = np.array([0.0, 1.0, 0.0])
"""From the robot to the customer, who stands on the other side of the table."""

DIRECTIONS_OF_ARMS = {"left": -1, "right": 1}
"""On which side of the middle, along x, an arm puts down what it was handed."""

SPOTS = 12
"""Places on the table among which one is looked for that an arm brings a thing to."""

ATTEMPTS = 3
"""Starts of inverse kinematics from which a place is looked at: they find 98 % of what all starts find on aloha_agilex
and 91 % on dual_panda, and a hand has many ways to take a thing there."""

DRAWS = 6
"""Ways to put a thing down that are tried in each zone."""


@dataclass(frozen=True)
class Ground:
    """The part of the table that things may stand on.

    Args:
        lower, upper: (2,) its corners, metres.
        height: z of the table top, metres.
        arms: of which one must reach what is put down; where none is given, it may stand anywhere.
    """

    lower: np.ndarray
    upper: np.ndarray
    height: float
    arms: tuple[ArmKinematics, ...] = ()

    @classmethod
    def of(cls, scene: Scene) -> Ground:
        """That of a scene, and what its robot reaches of it."""
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
        """Where a thing may stand so that a goal becomes true and it touches nothing, in the world.

        Args:
            thing: where it stood at the start.
            goal: whose subject it is: ``on`` the table, ``presented``, ``back``, ``handed`` to the arm of one side, or
                beside, left of… a thing.
            others: the other things, where they will be.
            rng: of all choices.
            taken: rectangles (2, 2) of the table that must stay free besides.
        """
        if goal.relation == "back":
            yield thing.pose
            return
        rectangles = [*(_footprint(o) for o in others), *taken]
        near = next((o for o in others if o.id == goal.reference), None)
        for yaws in _yaws(thing, goal):
            item = replace(table_item(thing.id, thing.asset), yaws=yaws)
            for lower, upper in self._zones(goal, near, max(item.size[:2]), rng):
                for _ in range(DRAWS):
                    try:
                        found = place([item], np.stack([lower, upper]), rng, margin=GAP, obstacles=rectangles)
                    except InfeasibleScene:
                        break
                    pose = item.pose(found[thing.id], self.height)
                    box = world_aabb(thing.asset.bounds, pose)
                    wanted = near is None or holds(goal.relation, box, near.aabb)  # pyrefly: ignore
                    if wanted and self._reached(thing, pose):
                        yield pose

    def _reached(self, thing: SceneObject, pose: Pose) -> bool:
        """Whether an arm gets to what stands at a pose, and up again."""
        return not self.arms or any(
            all(
                arm.reachable(Pose(grasp.pose.p + [0, 0, up], grasp.pose.q), ATTEMPTS)
                for up in (0, arm.arm.gripper.approach)
            )
            for arm in self.arms
            for contact in thing.asset.annotation.carrying_points
            for grasp in grasp_poses(pose, contact, arm.arm.gripper, self.height)
        )

    def _zones(
        self, goal: Goal, near: SceneObject | None, size: float, rng: np.random.Generator
    ) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Lower and upper corners of the rectangles in which the thing shall stand, in the order to try them."""
        if goal.relation == "presented":
            for depth in (CUSTOMER_SIDE, self.upper[1]):  # where it is full, anywhere on the customer's half
                yield np.array([self.lower[0], self.upper[1] - depth]), self.upper
            # and where arms are short, the near part of that
            yield np.array([self.lower[0], 0.0]), np.array([self.upper[0], self.upper[1] / 2])
        elif goal.relation == "handed" and goal.reference in DIRECTIONS_OF_ARMS:
            sign, middle = DIRECTIONS_OF_ARMS[goal.reference], (self.lower[0] + self.upper[0]) / 2
            yield (
                np.array([middle if sign > 0 else self.lower[0], self.lower[1]]),
                np.array([self.upper[0] if sign > 0 else middle, self.upper[1]]),
            )
        elif near is None:
            yield self.lower, self.upper
        else:
            words = [goal.relation] if goal.relation in DIRECTIONS else list(rng.permutation(list(DIRECTIONS)))
            reach = {"beside": BESIDE_GAP, "near": NEAR_GAP}.get(goal.relation, REACH)
            for word in words:
                zone = _side(near.aabb[:, :2], np.array(DIRECTIONS[word]), reach - WITHIN + size)
                lower, upper = np.maximum(zone[0], self.lower), np.minimum(zone[1], self.upper)
                if np.all(lower < upper):
                    yield lower, upper


def on_customers_half(pose: Pose) -> bool:
    """Whether a thing at ``pose`` is nearer to the customer than to the robot; the table's middle is the origin."""
    return float(pose.p @ TOWARDS_CUSTOMER) > 0


def faces_customer(pose: Pose, most: float = THRESHOLDS.shown_rad) -> bool:
    """Whether the front (−y) of a thing that stands at ``pose`` faces the customer, and the thing stands upright."""
    shown = float(-pose.rotation()[:, 1] @ TOWARDS_CUSTOMER)
    return bool(shown >= np.cos(most) and pose.rotation()[2, 2] >= np.cos(most))


def _yaws(thing: SceneObject, goal: Goal) -> list[tuple[float, ...]]:
    """Headings that do, and others for where no arm reaches it with those."""
    if goal.relation == "presented":
        return [tuple(np.pi + np.radians(off)) for off in ([0, -10, 10], [-20, 20])]
    quarters = np.radians([0, 90, 180, 270])
    return [tuple(thing.pose.yaw + quarters), tuple(quarters)]  # along the table's edges a box needs least room


def _side(box: np.ndarray, direction: np.ndarray, depth: float) -> np.ndarray:
    """(2, 2) the rectangle beside a box (2, 2) on one side, as wide as the box and a little more."""
    across = np.abs(direction[::-1]) * SIDEWAYS
    zone = box + np.stack([-across, across])
    along = int(np.argmax(np.abs(direction)))
    zone[:, along] = (
        (box[1, along], box[1, along] + depth) if direction[along] > 0 else (box[0, along] - depth, box[0, along])
    )
    return zone


def _footprint(thing: SceneObject) -> np.ndarray:
    """(2, 2) the table that a thing covers, and what its moving parts sweep."""
    item = table_item(thing.id, thing.asset)
    half, centre = np.array(item.size[:2]) / 2, np.array(item.centre)
    bounds = np.array([[*(centre - half), 0.0], [*(centre + half), item.size[2]]])
    return world_aabb(bounds, thing.pose)[:, :2]
