"""Shake: an object in a hand is tilted to and fro about its middle."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from vcage.base.geometry import Pose
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import JointPath, Load
from vcage.sim.state import WorldState
from vcage.tasks.primitives.grip import Grip, feel, minding
from vcage.tasks.workcell import Workcell, failing_at


@dataclass(frozen=True)
class ShakeSettings:
    """The motion of a shake.

    Args:
        leans_rad: angles to each side, the first that an arm can do.
        rises_m: how much higher it is done than the object was lifted, the first that has room.
        axes: of the world that it leans about: the customer sees best how it leans to the left and to the right.
        times: leans in all; the one more than is asked for allows for a lazy hand.
        speed: share of the speed limit.
    """

    leans_rad: tuple[float, ...] = tuple(np.radians([25.0, 20.0]))
    rises_m: tuple[float, ...] = (0.0, 0.05, 0.1, 0.15, -0.04)
    axes: tuple[tuple[float, float, float], ...] = ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    times: int = 4
    speed: float = 0.6


SETTINGS = ShakeSettings()


def carry_out_shake(cell: Workcell, grip: Grip) -> WorldState:
    """Tilt a lifted object to and fro, and bring it back to where the shake began; the state at the first lean.

    Raises:
        TaskFailed: no way can be planned, or the object slips out of the fingers.
    """
    control, middle = cell.world.arms[grip.arm], cell.object(grip.object_id).aabb.mean(axis=0)
    with failing_at("plan"):
        first, others = plan_shake(
            cell.planner(grip.arm), cell.begun(grip.arm).end, control.tool_pose, middle, grip.load
        )
    with minding(cell, grip):
        cell.carry_out(grip.arm, first)
        leaning = cell.world.state()
        cell.carry_out(grip.arm, others)
    feel(cell, grip)
    return leaning


def plan_shake(
    planner: MotionPlanner, start: np.ndarray, gripper: Pose, middle: np.ndarray, load: Load
) -> tuple[JointPath, JointPath]:
    """The way to the first lean, and the others: about the axis towards the customer, else about the other one.

    Args:
        planner: of the arm.
        start: (n,) its joints when the object is lifted, rad.
        gripper: pose of the gripper frame then.
        middle: (3,) the middle of the object then, in the world.
        load: the object in the hand.

    Raises:
        MotionFailed: no way is free.
    """
    reason, load = "", replace(load, speed=SETTINGS.speed)
    for lean, still in _leans(gripper, middle):
        try:
            first = planner.follow(start, [still, lean[0]], load)
            ways = [lean[number % 2] for number in range(1, SETTINGS.times)]
            return first, planner.follow(first.end, [*ways, still], load)
        except MotionFailed as error:
            reason = reason or error.message
    raise MotionFailed(f"it cannot be tilted to and fro there: {reason}")


def _leans(gripper: Pose, middle: np.ndarray) -> Iterator[tuple[tuple[Pose, Pose], Pose]]:
    """Poses of the gripper at the two ends of a shake, and between them."""
    for axis, lean, rise in product(SETTINGS.axes, SETTINGS.leans_rad, SETTINGS.rises_m):
        up, (c, s) = Pose([0.0, 0.0, rise]), (np.cos(lean / 2), np.sin(lean / 2) * np.array(axis))
        there, back = (up * Pose(middle) * Pose(q=[c, *side]) * Pose(-middle) * gripper for side in (s, -s))
        yield (there, back), up * gripper
