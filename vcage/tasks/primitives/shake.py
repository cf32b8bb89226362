"""Shake: an object in a hand is tilted to and fro about its middle."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from vcage.base.geometry import Pose, box_corners, tilt_between
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import JointPath, Load
from vcage.sim.state import WorldState
from vcage.tasks.holding import SETTINGS as HOLDING
from vcage.tasks.primitives.grip import Grip, feel, minding
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.workcell import TaskFailed, Workcell, failing_at


@dataclass(frozen=True)
class ShakeSettings:
    """The motion of a shake.

    Args:
        leans_rad: angles to each side, the first that an arm can do.
        rises_m: how much higher it is done than the object was lifted, the first that has room.
        axes: of the world that it leans about. Those across the line from finger to finger come first, as an object
            turns between two fingers; then as listed, as the customer sees best how it leans to the left and right.
        times: leans in all, an even number, so that the last is opposite to the first; the one more than is asked for
            allows for a lazy hand.
        speed: share of the speed limit.
        tilts_rad: angle by which an object may have sagged in the hand since it was lifted: beyond, it hardly leans to
            both sides.
    """

    leans_rad: tuple[float, ...] = tuple(np.radians([25.0, 20.0]))
    rises_m: tuple[float, ...] = (0.0, 0.05, 0.1, 0.15, -0.04)
    axes: tuple[tuple[float, float, float], ...] = (
        (0.0, 1.0, 0.0),
        (math.sqrt(0.5), math.sqrt(0.5), 0.0),
        (-math.sqrt(0.5), math.sqrt(0.5), 0.0),
        (1.0, 0.0, 0.0),
    )
    times: int = 4
    speed: float = 0.6
    tilts_rad: float = float(np.radians(20.0))


SETTINGS = ShakeSettings()


def carry_out_shake(cell: Workcell, grip: Grip) -> tuple[WorldState, WorldState]:
    """Tilt a lifted object to and fro, and bring it back to where the shake began; the states at the first and the last
    lean, which are at opposite sides.

    Raises:
        TaskFailed: no way can be planned, or the object slips out of the fingers or tilts between them.
    """
    hand, thing, table = cell.world.arms[grip.arm].tool_pose, cell.object(grip.object_id), cell.world.table.height
    with failing_at("plan"):
        planner, start = cell.planner(grip.arm), cell.begun(grip.arm).end
        first, others, end = plan_shake(planner, start, hand, thing, table, grip.load)
    with minding(cell, grip):
        cell.carry_out(grip.arm, first)
        there = cell.world.state()
        cell.carry_out(grip.arm, others)
        back = cell.world.state()
        cell.carry_out(grip.arm, end)
    feel(cell, grip)
    grasped = grip.grasped or grip.load.held
    tilted = 0.0 if grasped is None else tilt_between(cell.object(grip.object_id).pose, hand * grasped.in_gripper)
    if tilted > SETTINGS.tilts_rad:
        raise TaskFailed("grasp", f"{grip.object_id} tilted by {np.degrees(tilted):.0f}° in the hand that shook it")
    return there, back


def plan_shake(
    planner: MotionPlanner, start: np.ndarray, gripper: Pose, thing: SceneObject, table_height: float, load: Load
) -> tuple[JointPath, JointPath, JointPath]:
    """The ways to the first lean, over the others to the last, and to the end: about the first axis with room.

    Args:
        planner: of the arm.
        start: (n,) its joints when the object is lifted, rad.
        gripper: pose of the gripper frame then.
        thing: the object then.
        table_height: z of the table, metres; leaning, too, the object stays well above it.
        load: the object in the hand.

    Raises:
        MotionFailed: no way is free.
    """
    reason, load = "", replace(load, speed=SETTINGS.speed)
    for lean, still in leans(gripper, thing, table_height + HOLDING.clear_m):
        try:
            first = planner.follow(start, [still, lean[0]], load)
            others = planner.follow(first.end, [lean[number % 2] for number in range(1, SETTINGS.times)], load)
            return first, others, planner.follow(others.end, [still], load)
        except MotionFailed as error:
            reason = reason or error.message
    raise MotionFailed(f"it cannot be tilted to and fro there: {reason or 'it would come too near the table'}")


def leans(gripper: Pose, thing: SceneObject, lowest: float) -> Iterator[tuple[tuple[Pose, Pose], Pose]]:
    """Poses of the gripper at the two ends of a shake, and between them, at which no part of the object is lower than
    ``lowest`` (z, metres)."""
    middle, corners = thing.aabb.mean(axis=0), thing.pose.apply(box_corners(*thing.asset.bounds))
    closing = gripper.rotation()[:, 1]
    axes = sorted(SETTINGS.axes, key=lambda axis: round(abs(float(closing @ axis)), 1))
    for axis, lean, rise in product(axes, SETTINGS.leans_rad, SETTINGS.rises_m):
        up, (c, s) = Pose([0.0, 0.0, rise]), (np.cos(lean / 2), np.sin(lean / 2) * np.array(axis))
        there, back = (up * Pose(middle) * Pose(q=[c, *side]) * Pose(-middle) for side in (s, -s))
        if min(way.apply(corners)[:, 2].min() for way in (there, back)) >= lowest:
            yield (there * gripper, back * gripper), up * gripper
