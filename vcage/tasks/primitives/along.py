"""Along a way: an object in a hand is brought to where its way begins, and follows it pose by pose."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from vcage.base.geometry import Pose
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import JointPath, Load
from vcage.tasks.workcell import TaskFailed, first_reasons


def plan_along(
    planner: MotionPlanner, start: np.ndarray, load: Load, way: Sequence[Pose], speed: float
) -> tuple[JointPath, JointPath]:
    """The motion of a lifted object to where a way begins, and along that.

    Args:
        planner: of the arm.
        start: (n,) its joints, rad.
        load: the object in the hand.
        way: poses of the object.
        speed: share of the speed limit along the way.

    Raises:
        MotionFailed: the arm cannot go there, or touches something.
    """
    first, *others = hands_at(load, way)
    carry = planner.move(start, first, load, then=others)
    return carry, planner.follow(carry.end, others, going(load, speed))


def going(load: Load, speed: float) -> Load:
    """The load along a way: at a share of the speed limit, and with no free room kept below it."""
    return Load(load.opening, None if load.held is None else replace(load.held, clearance=0.0), speed=speed)


Planned = TypeVar("Planned")


def first_free(plan: Callable[[Sequence[Pose]], Planned], ways: Iterable[Sequence[Pose]], what: str) -> Planned:
    """The plan of the first way that can be planned.

    Args:
        plan: plans the motion along a way; raises :class:`MotionFailed`.
        ways: in the order to try.
        what: cannot be done where there is none, as in "tipped over the container".

    Raises:
        TaskFailed: there is none.
    """
    reasons: list[str] = []
    for way in ways:
        try:
            return plan(way)
        except MotionFailed as error:
            reasons.append(error.message)
    raise TaskFailed("plan", f"it cannot be {what}: {first_reasons(reasons)}")


def require_along(
    planner: MotionPlanner, start: np.ndarray, load: Load, way: Sequence[Pose], unreached: str
) -> np.ndarray:
    """Require that an object can follow a way, and the arm touches nothing there; returns the (n,) joints at its end.

    Args:
        planner, load, way: as of :func:`plan_along`.
        start: (n,) joints before it is brought to the first pose, rad.
        unreached: the complaint where no joints reach that.

    Raises:
        MotionFailed: it cannot; says why.
    """
    first, *others = hands_at(load, way)
    reason = unreached
    for there in planner.kinematics.ik_all(first, start):
        try:
            planner.check(there, load)
            return planner.follow(there, others, load).end
        except MotionFailed as error:
            reason = error.message
    raise MotionFailed(reason)


def hands_at(load: Load, way: Sequence[Pose]) -> list[Pose]:
    """Poses of the gripper frame at which the object in a hand is at some poses."""
    assert load.held is not None, "an object is in the hand"
    return [pose * load.held.in_gripper.inverse() for pose in way]
