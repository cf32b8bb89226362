"""Come down: a tool in a hand is lowered until it presses on what it hits or wipes, and stops."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from vcage.base.geometry import Pose
from vcage.schema.plan import TABLE
from vcage.sim.motion import MotionPlanner
from vcage.sim.paths import JointPath, Load
from vcage.sim.state import WorldState
from vcage.sim.world import PHYSICS_HZ, World
from vcage.tasks.primitives.grip import Grip
from vcage.tasks.touching import SETTINGS as TOUCHING
from vcage.tasks.touching import Allowance, Touched, only_touching
from vcage.tasks.workcell import TaskFailed, Workcell, failing_at


@dataclass(frozen=True)
class ComeDownSettings:
    """The way down of a tool.

    Args:
        farther_m: how much farther down than the top it goes where nothing is touched: a tool may hang lower or higher.
        speed: share of the speed limit on the way down.
        pressed_steps: physics steps without a break in which the tool presses on the thing before it stops: an arm that
            stops at the first touch keeps a tool between firm fingers some tenths of a millimetre above it.
        rests_s: how long the tool rests on what it touched.
    """

    farther_m: float = 0.02
    speed: float = 0.3
    pressed_steps: int = 5
    rests_s: float = 0.2


SETTINGS = ComeDownSettings()


def plan_down(cell: Workcell, grip: Grip, thing_id: str, above_m: float) -> JointPath:
    """The way straight down from where a tool is held over an object, through its top.

    Args:
        cell: in its present state.
        grip: the tool in the hand.
        thing_id: the object under it.
        above_m: height of the tool over the top, metres.

    Raises:
        TaskFailed: the arm cannot go there.
    """
    held = cell.held(grip.object_id, cell.world.arms[grip.arm].tool_pose)
    with failing_at("plan"):
        start, load = cell.begun(grip.arm).end, Load(grip.load.opening, held)
        return way_down(cell.planner(grip.arm), start, load, cell.parts(thing_id), above_m)


def way_down(
    planner: MotionPlanner, start: np.ndarray, load: Load, thing: Collection[str], above_m: float
) -> JointPath:
    """The way straight down with a tool that is held over an object; through a thin one into the table, if need be.

    Args:
        planner: of the arm.
        start: (n,) joints over it, rad.
        load: the tool in the hand.
        thing: names of the object and its parts.
        above_m: height of the tool over the top, metres.

    Raises:
        MotionFailed: the arm cannot go there.
    """
    over = planner.kinematics.fk(start)
    down = Pose(over.p - [0.0, 0.0, above_m + SETTINGS.farther_m], over.q)
    return planner.line(start, down, replace(load, ignore=[*thing, TABLE], speed=SETTINGS.speed))


def carry_out_down(cell: Workcell, grip: Grip, thing_id: str, down: JointPath, does: str) -> WorldState:
    """Come down until the tool presses on the object, and rest there; the state then.

    Args:
        cell: in its present state.
        grip: the tool in the hand, over the object.
        thing_id: what it comes down on.
        down: of :func:`plan_down`.
        does: the verb for messages, such as ``hits``.

    Raises:
        TaskFailed: something else is touched, or nothing.
    """
    control, world = cell.world.arms[grip.arm], cell.world
    tool, thing = (f"the {cell.object(name).record.phrase}" for name in (grip.object_id, thing_id))
    may = Allowance("load", frozenset([thing_id]))
    try:
        with only_touching(world, grip.arm, grip.object_id, [may], grip.contents):
            # The way ends between two steps of the world: recorders saw each step once.
            pressed = 0
            for _ in control.follow(cell.planner(grip.arm).fastest(down)):
                world.step()
                pressed = pressed + 1 if _touches(world, grip.object_id, thing_id) else 0
                if pressed == SETTINGS.pressed_steps:
                    break
            else:
                raise TaskFailed("place", f"{tool} touches nothing where {thing} should be")
            control.stop()
            world.step(round(SETTINGS.rests_s * PHYSICS_HZ))
    except Touched as touched:
        mine = tool if touched.by == "load" else f"the {grip.arm} arm"
        raise TaskFailed("place", f"{mine} touches {touched.other} when {tool} {does} {thing}") from touched
    return world.state()


def _touches(world: World, tool_id: str, thing_id: str) -> bool:
    """True where a tool has pressed on an object in the last step."""
    presses = ((other.partition("/")[0], impulse) for _, other, impulse in world.presses({tool_id}))
    return any(other == thing_id and impulse * PHYSICS_HZ >= TOUCHING.least_force_n for other, impulse in presses)
