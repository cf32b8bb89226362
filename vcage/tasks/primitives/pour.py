"""Pour: a vessel in a hand is tipped over a container until all has rolled out of it, and turned upright again."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice

from vcage.base.geometry import Pose
from vcage.sim.paths import JointPath, Leg, Load
from vcage.sim.state import WorldState
from vcage.sim.world import PHYSICS_HZ
from vcage.tasks.pouring import left_in
from vcage.tasks.primitives.along import first_free, plan_along
from vcage.tasks.primitives.grip import Grip
from vcage.tasks.touching import Allowance
from vcage.tasks.workcell import TaskFailed, Workcell


@dataclass(frozen=True)
class PourSettings:
    """The motion of pouring.

    Args:
        speed: share of the speed limit while the vessel is tipped: what rolls out slowly falls near the lip.
        looks_s, most_s: time between two looks at what is left in it, and the longest time that it is held there.
        jerks, jerk_share: times that it is turned back by a share of the way and tipped again where something sticks in
            it, and that share.
        rests_s: how long it is held after the last ball.
        ways: that are tried at most with the vessel in the hand.
    """

    speed: float = 0.2
    looks_s: float = 0.1
    most_s: float = 0.8
    jerks: int = 3
    jerk_share: float = 0.25
    rests_s: float = 0.4
    ways: int = 12


SETTINGS = PourSettings()


def carry_out_pour(
    cell: Workcell, grip: Grip, target_id: str, ways: Iterable[Sequence[Pose]]
) -> tuple[WorldState, Grip]:
    """Bring a vessel over a container, tip it and turn it back; the state when it is tipped, and the empty vessel.

    Args:
        cell: in its present state.
        grip: the vessel in the hand, lifted.
        target_id: the container.
        ways: poses of the vessel over that, upright first; in the order to try.

    Raises:
        TaskFailed: no way can be planned, something else is touched, or a ball stays in the vessel.
    """
    control, start = cell.world.arms[grip.arm], cell.begun(grip.arm)
    load = replace(grip.carrying, held=cell.held(grip.object_id, control.tool_pose))
    plan = partial(plan_along, cell.planner(grip.arm), start.end, load, speed=SETTINGS.speed)
    carry, tip = first_free(plan, islice(ways, SETTINGS.ways), "tipped over the container")
    cell.carry_out(grip.arm, start.then(carry))
    may = Allowance("load", frozenset([target_id, *cell.contents(target_id)]))
    cell.carry_out(grip.arm, tip, [may])
    tipped = cell.world.state()
    _empty(cell, grip, tip, may)
    cell.emptied(grip.object_id)
    empty = Load(grip.load.opening, cell.held(grip.object_id, control.tool_pose), speed=SETTINGS.speed)
    cell.carry_out(grip.arm, JointPath((Leg(tip.points()[::-1], empty),)))
    held = cell.held(grip.object_id, control.tool_pose)
    return tipped, replace(grip, load=replace(grip.load, held=held), contents=frozenset())


def _empty(cell: Workcell, grip: Grip, tip: JointPath, may: Allowance) -> None:
    """Hold a tipped vessel until nothing is in it; where something sticks, jerk it.

    Args:
        cell, grip: with the vessel in the hand.
        tip: the motion that has tipped it.
        may: what its contents may touch.

    Raises:
        TaskFailed: a ball stays there.
    """
    points, load = tip.points(), tip.legs[-1].load
    last = points[-max(2, round(SETTINGS.jerk_share * len(points))) :]
    jerk = JointPath((Leg(last[::-1], load), Leg(last, load)))
    left = _left_after_a_while(cell, grip)
    for _ in range(SETTINGS.jerks):
        if not left:
            break
        cell.carry_out(grip.arm, jerk, [may])
        left = _left_after_a_while(cell, grip)
    if left:
        vessel = cell.object(grip.object_id).record.phrase
        raise TaskFailed("place", f"{left} of {len(grip.contents)} stay in the {vessel} when it is tipped")
    cell.world.step(round(SETTINGS.rests_s * PHYSICS_HZ))


def _left_after_a_while(cell: Workcell, grip: Grip) -> int:
    """Number of balls in a vessel that is held; as soon as there are none, else after the longest time."""
    for _ in range(round(SETTINGS.most_s / SETTINGS.looks_s)):
        if not _left(cell, grip):
            return 0
        cell.world.step(round(SETTINGS.looks_s * PHYSICS_HZ))
    return _left(cell, grip)


def _left(cell: Workcell, grip: Grip) -> int:
    """Number of balls in a vessel that is held now."""
    return len(left_in(cell.object(grip.object_id), map(cell.object, sorted(grip.contents))))
