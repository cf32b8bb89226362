"""Slide: a thing in a hand is slid over a peg or into a hole, and let go there."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from vcage.base.geometry import Pose
from vcage.sim.motion import MotionPlanner
from vcage.sim.paths import JointPath, Load
from vcage.sim.state import WorldState
from vcage.sim.world import PHYSICS_HZ
from vcage.tasks.grasps import approach_opening, command_of
from vcage.tasks.primitives.along import first_free, going, hands_at
from vcage.tasks.primitives.grip import Grip, feel, minding
from vcage.tasks.touching import Allowance
from vcage.tasks.workcell import CAREFUL_SPEED_SHARE, Workcell, failing_at


@dataclass(frozen=True)
class Sliding:
    """A motion of a thing along a peg or a hole.

    Args:
        done: as in "it cannot be slid over the peg".
        where: the place, in words.
        speed: share of the speed limit along it.
        waits_s: how long the hand waits, open, for the thing to come to rest.
        ways: that are tried at most with the thing in the hand.
    """

    done: str
    where: str
    speed: float = 0.3
    waits_s: float = 0.6
    ways: int = 12


OVER_A_PEG = Sliding("slid over the peg", "the peg")
INTO_A_HOLE = Sliding("slid into the hole", "the hole", speed=0.2, waits_s=0.3)


def carry_out_slide(
    cell: Workcell, grip: Grip, target_id: str, ways: Iterable[Sequence[Pose]], sliding: Sliding
) -> WorldState:
    """Slide a thing along one of some ways, let it go, and draw the hand back upwards with the following motion.

    Returns the state before it is let go.

    Args:
        cell: in its present state.
        grip: the thing in the hand, lifted.
        target_id: id of what has the peg or the hole, which the thing may touch.
        ways: poses of the thing; in the order to try.
        sliding: how it is slid.

    Raises:
        TaskFailed: no way can be planned, the thing is lost, or something else is touched.
    """
    control, start = cell.world.arms[grip.arm], cell.begun(grip.arm)
    load = replace(grip.carrying, held=cell.held(grip.object_id, control.tool_pose))
    planner = cell.planner(grip.arm)

    def carried_to(way: Sequence[Pose]) -> tuple[JointPath, Sequence[Pose]]:
        carry, _ = plan_slide(planner, start.end, load, way, sliding)  # the slide is planned again, as it is held then
        return carry, way

    carry, way = first_free(carried_to, islice(ways, sliding.ways), sliding.done)
    with minding(cell, grip):
        cell.carry_out(grip.arm, start.then(carry))
        now = replace(load, held=cell.held(grip.object_id, control.tool_pose))  # shifted on the way
        with failing_at("place"):
            slide = _along(planner, carry.end, now, way, sliding)
        cell.carry_out(grip.arm, slide, [Allowance("load", frozenset([target_id]))])
    feel(cell, grip)
    moment, gripper = cell.world.state(), control.arm.gripper
    opened = command_of(approach_opening(control.finger_width, gripper), gripper)
    control.release(opened)
    cell.let_go(grip.object_id)
    cell.world.step(round(sliding.waits_s * PHYSICS_HZ))
    up = Pose(control.tool_pose.p + [0.0, 0.0, gripper.approach], control.tool_pose.q)
    away = Load(opened, ignore=cell.parts(grip.object_id), speed=CAREFUL_SPEED_SHARE)
    with failing_at("place"):
        rise = cell.planner(grip.arm).line(slide.end, up, away)
    cell.put_off(grip.arm, rise, [Allowance("hand", frozenset([grip.object_id]))])
    return moment


def plan_slide(
    planner: MotionPlanner, start: np.ndarray, load: Load, way: Sequence[Pose], sliding: Sliding
) -> tuple[JointPath, JointPath]:
    """The motion of a lifted thing to where a way begins, and along that, with a stop before its last pose.

    Args:
        planner: of the arm.
        start: (n,) its joints, rad.
        load: the thing in the hand.
        way: poses of the thing.
        sliding: how it is slid.

    Raises:
        MotionFailed: the arm cannot go there, or touches something.
    """
    first, *others = hands_at(load, way)
    carry = planner.move(start, first, load, then=others)
    return carry, _along(planner, carry.end, load, way, sliding)


def _along(planner: MotionPlanner, start: np.ndarray, load: Load, way: Sequence[Pose], sliding: Sliding) -> JointPath:
    """The motion along a way from near its first pose; arguments and errors as of :func:`plan_slide`."""
    *before, last = hands_at(load, way)
    slow = going(load, sliding.speed)
    slide = planner.follow(start, before, slow)
    return slide.then(planner.line(slide.end, last, slow))
