"""Hang: the loop of a thing in a hand is slid over a peg and lowered onto it, and the thing is let go."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice

import numpy as np

from vcage.base.geometry import Pose
from vcage.sim.motion import MotionPlanner
from vcage.sim.paths import JointPath, Load
from vcage.sim.state import WorldState
from vcage.sim.world import PHYSICS_HZ
from vcage.tasks.grasps import approach_opening, command_of
from vcage.tasks.primitives.along import first_free, hands_at, plan_along
from vcage.tasks.primitives.grip import Grip, feel, minding
from vcage.tasks.touching import Allowance
from vcage.tasks.workcell import CAREFUL_SPEED_SHARE, Workcell, failing_at


@dataclass(frozen=True)
class HangSettings:
    """The motion of hanging.

    Args:
        speed: share of the speed limit along the peg.
        swings_s: how long the hand waits, open, for the thing to swing down.
        ways: that are tried at most with the thing in the hand.
    """

    speed: float = 0.3
    swings_s: float = 0.6
    ways: int = 12


SETTINGS = HangSettings()


def carry_out_hang(cell: Workcell, grip: Grip, rack_id: str, ways: Iterable[Sequence[Pose]]) -> WorldState:
    """Slide a thing over a peg, lower it, let it go, and draw the hand back upwards with the following motion.

    Returns the state before it is let go.

    Args:
        cell: in its present state.
        grip: the thing in the hand, lifted.
        rack_id: id of the rack.
        ways: poses of the thing; in the order to try.

    Raises:
        TaskFailed: no way can be planned, the thing is lost, or something else is touched.
    """
    control, start = cell.world.arms[grip.arm], cell.begun(grip.arm)
    load = replace(grip.carrying, held=cell.held(grip.object_id, control.tool_pose))
    plan = partial(plan_hang, cell.planner(grip.arm), start.end, load)
    carry, slide = first_free(plan, islice(ways, SETTINGS.ways), "slid over the peg")
    with minding(cell, grip):
        cell.carry_out(grip.arm, start.then(carry))
        cell.carry_out(grip.arm, slide, [Allowance("load", frozenset([rack_id]))])
    feel(cell, grip)
    moment, gripper = cell.world.state(), control.arm.gripper
    opened = command_of(approach_opening(control.finger_width, gripper), gripper)
    control.release(opened)
    cell.let_go(grip.object_id)
    cell.world.step(round(SETTINGS.swings_s * PHYSICS_HZ))
    up = Pose(control.tool_pose.p + [0.0, 0.0, gripper.approach], control.tool_pose.q)
    away = Load(opened, ignore=cell.parts(grip.object_id), speed=CAREFUL_SPEED_SHARE)
    with failing_at("place"):
        rise = cell.planner(grip.arm).line(slide.end, up, away)
    cell.put_off(grip.arm, rise, [Allowance("hand", frozenset([grip.object_id]))])
    return moment


def plan_hang(
    planner: MotionPlanner, start: np.ndarray, load: Load, way: Sequence[Pose]
) -> tuple[JointPath, JointPath]:
    """The motion of a lifted thing to before the tip of a peg, and over the peg and down on it.

    Args:
        planner: of the arm.
        start: (n,) its joints, rad.
        load: the thing in the hand.
        way: poses of the thing, the lowered one last.

    Raises:
        MotionFailed: the arm cannot go there, or touches something.
    """
    *sliding, lowered = way
    carry, slide = plan_along(planner, start, load, sliding, SETTINGS.speed)
    down = planner.line(slide.end, hands_at(load, [lowered])[0], slide.legs[-1].load)
    return carry, slide.then(down)
