"""Wipe: a tool in a hand that lies on an object is drawn to and fro over its top."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from vcage.base.geometry import Pose
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import JointPath, Load
from vcage.sim.state import WorldState
from vcage.sim.world import World
from vcage.tasks.primitives.come_down import SETTINGS as COMING_DOWN
from vcage.tasks.primitives.come_down import way_down
from vcage.tasks.primitives.grip import Grip
from vcage.tasks.touching import Allowance
from vcage.tasks.wiping import SETTINGS as WIPING
from vcage.tasks.wiping import farthest, flat_top
from vcage.tasks.workcell import TaskFailed, Workcell, failing_at


@dataclass(frozen=True)
class WipeSettings:
    """The motion of wiping.

    Args:
        press_m: how much lower than at the first touch the hand moves, so that the pad stays on the top.
        light_kg, light_press_m: of a lighter thing it moves this much lower: else a sponge takes a mat along.
        every_steps, touching_share: physics steps between two looks at the contact, and share of them with one.
        clear_m: height over the top at which the room for the hand is examined.
        speed: share of the speed limit.
    """

    press_m: float = 0.001
    light_kg: float = 0.2
    light_press_m: float = 0.0004
    every_steps: int = 10
    touching_share: float = 0.8
    clear_m: float = 0.002
    speed: float = 0.3


SETTINGS = WipeSettings()


def carry_out_wipe(cell: Workcell, grip: Grip, thing_id: str, way: Sequence[Pose]) -> WorldState:
    """Draw the tool over the top that it lies on; the state at the end of the stroke that leads farthest.

    Args:
        cell: in its present state.
        grip: the tool in the hand, on the object.
        thing_id: what it wipes.
        way: poses of the tool where strokes begin and end, at any height.

    Raises:
        TaskFailed: no way can be planned, or something else is touched.
    """
    planner, start = cell.planner(grip.arm), cell.begun(grip.arm).end
    held = cell.held(grip.object_id, cell.world.arms[grip.arm].tool_pose)
    lies = cell.object(grip.object_id).pose.p
    with failing_at("plan"):
        shifts = [(pose.p - lies)[:2] for pose in way]
        light = cell.object(thing_id).asset.model.total_mass < SETTINGS.light_kg
        press = _gap(cell, grip.object_id, thing_id) + (SETTINGS.light_press_m if light else SETTINGS.press_m)
        paths = strokes(planner, start, Load(grip.load.opening, held), cell.parts(thing_id), shifts, press)
    may, far = Allowance("load", frozenset([thing_id])), cell.world.state()
    with _touching(cell, grip.object_id, thing_id):
        for number, path in enumerate(paths):
            cell.carry_out(grip.arm, path, [may])
            far = cell.world.state() if number == farthest(way) else far
    return far


def _gap(cell: Workcell, tool_id: str, thing_id: str) -> float:
    """Height of a tool over the flat top of an object, metres: it springs back a little where it first touches."""
    thing, tool = cell.object(thing_id), cell.object(tool_id)
    top = flat_top(thing)
    return 0.0 if top is None else max(0.0, tool.lowest - float(thing.pose.apply([*top.centre, top.floor])[2]))


@contextmanager
def _touching(cell: Workcell, tool_id: str, thing_id: str) -> Iterator[None]:
    """Feel that a tool stays on an object most of the time while the block inside runs.

    Raises:
        TaskFailed: it lifted off.
    """
    felt: list[bool] = []

    def feel(world: World) -> None:
        if world.steps % SETTINGS.every_steps == 0:
            felt.append(thing_id in {other.partition("/")[0] for other in world.touching(tool_id)})

    cell.world.before_step.append(feel)
    try:
        yield
    finally:
        cell.world.before_step.remove(feel)
    if sum(felt) < SETTINGS.touching_share * len(felt):
        tool, thing = (f"the {cell.object(name).record.phrase}" for name in (tool_id, thing_id))
        raise TaskFailed("place", f"{tool} lifted off {thing} on its way over that")


def strokes(
    planner: MotionPlanner,
    start: np.ndarray,
    load: Load,
    thing: Collection[str],
    shifts: Sequence[np.ndarray],
    press: float = SETTINGS.press_m,
) -> list[JointPath]:
    """Straight ways of a tool that lies on an object, one after the other.

    Args:
        planner: of the arm.
        start: (n,) its joints, rad.
        load: the tool in the hand.
        thing: names of the object and its parts.
        shifts: (2,) from where the tool is to where each of them ends, metres.
        press: how much lower the hand moves, metres.

    Raises:
        MotionFailed: the arm cannot go there.
    """
    at, found = planner.kinematics.fk(start), list[JointPath]()
    touching = replace(load, ignore=[*thing], speed=SETTINGS.speed)
    for shift in shifts:
        pose = Pose(at.p + [*shift, -press], at.q)
        found.append(planner.line(found[-1].end if found else start, pose, touching))
    return found


def require_way(planner: MotionPlanner, start: np.ndarray, load: Load, way: Sequence[Pose]) -> None:
    """Require that a tool can be drawn along a way, and the arm touches nothing there.

    Args:
        planner: of the arm.
        start: (n,) its joints before, rad.
        load: the tool in the hand.
        way: poses of the tool, over the top, where strokes begin and end.

    Raises:
        MotionFailed: the arm cannot go there, or touches something; names it.
    """
    assert load.held is not None, "a tool is in the hand"
    on_top = [0.0, 0.0, WIPING.above_m - SETTINGS.clear_m]
    hands = [Pose(pose.p - on_top, pose.q) * load.held.in_gripper.inverse() for pose in way]
    there = planner.kinematics.ik(hands[0], start)
    if there is None:
        raise MotionFailed("the top is out of reach")
    planner.check(there, load)
    planner.follow(there, hands[1:], load)


def rehearse_wipe(
    planner: MotionPlanner, start: np.ndarray, load: Load, thing: Collection[str], way: Sequence[Pose]
) -> None:
    """Plan the way down of a tool that is held over an object, and its strokes there.

    Args:
        planner, start, load, thing: as of :func:`strokes`.
        way: poses of the tool where strokes begin and end.

    Raises:
        MotionFailed: the arm cannot go there.
    """
    down = way_down(planner, start, load, thing, WIPING.above_m - COMING_DOWN.farther_m)
    strokes(planner, down.end, load, thing, [(pose.p - way[0].p)[:2] for pose in way])
