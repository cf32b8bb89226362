"""Hold with both: two arms take hold of one object and raise it at the same time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import islice, pairwise

import numpy as np

from vcage.base.geometry import Pose
from vcage.sim.kinematics import kinematics_of
from vcage.sim.motion import SETTINGS as MOTION
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import JointPath, Load
from vcage.sim.speed_profile import ArmsTogether, time_optimal
from vcage.sim.state import WorldState
from vcage.sim.trajectory import Trajectory
from vcage.sim.world import PHYSICS_HZ
from vcage.tasks.grasps import approach_opening, command_of
from vcage.tasks.holding import SETTINGS as HOLDING
from vcage.tasks.holds_with_both import Hands, OneHand, holds_with_both
from vcage.tasks.primitives.pick import PickWay
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.touching import at_rest
from vcage.tasks.workcell import CAREFUL_SPEED_SHARE, TaskFailed, Workcell, failing_at, first_reasons


@dataclass(frozen=True)
class HoldSettings:
    """The motion of two arms with one object.

    Args:
        tried: pairs of holds for which every motion is planned before there is none.
        step_m: between the heights for which the joints of both arms are solved.
        speed: share of the speed limit: what the one arm is behind the other strains the object.
    """

    tried: int = 24
    step_m: float = 0.01
    speed: float = 0.25


SETTINGS = HoldSettings()


@dataclass(frozen=True)
class PlanWithBoth:
    """A lift that two arms can do.

    Args:
        target: the object, at its place.
        hands: how each arm holds it, the first to take hold first.
        reaches: ways of the arms to it, by name.
        lifts: (k, n) joints of the arms while they rise, by name.
    """

    target: SceneObject
    hands: Hands
    reaches: Mapping[str, JointPath]
    lifts: Mapping[str, np.ndarray]


def plan_with_both(cell: Workcell, target: SceneObject, skip: int = 0) -> PlanWithBoth:
    """The first pair of holds by which two arms can take an object and raise it.

    Args:
        cell: in its present state.
        target: the object, at its place.
        skip: pairs of holds to leave out, as they are known to fail.

    Raises:
        TaskFailed: there is none.
    """
    arms = {name: kinematics_of(control.arm) for name, control in cell.world.arms.items()}
    others, reasons, left = cell.objects_but(target.id, *cell.contents(target.id)), list[str](), skip
    try:
        for hands in islice(holds_with_both(target, arms, others), SETTINGS.tried):
            try:
                plan = _planned(cell, target, hands)
            except MotionFailed as error:
                reasons.append(error.message)
                continue
            if not left:
                return plan
            left -= 1
    except MotionFailed as error:
        reasons.append(error.message)
    why = first_reasons(reasons)
    raise TaskFailed("plan", f"no lift of {target.record.phrase} with both arms can be planned: {why}", exhausted=True)


def _planned(cell: Workcell, target: SceneObject, hands: Hands) -> PlanWithBoth:
    """The motions of both arms.

    Raises:
        MotionFailed: one of them is not free.
    """
    (first, mine), (second, other) = hands.items()
    parts = cell.parts(target.id, *cell.contents(target.id))
    reach = _reach(cell.planner(first), cell.begun(first), mine, parts)
    then = _reach(cell.planner_among(second, {first: reach.end}, {}), cell.begun(second), other, parts)
    reaches = {first: reach, second: then}
    lifts = {name: _rise(cell, name, reaches[name].end, hands[name]) for name in hands}
    body = cell.world.body(target.id)
    lifted = {target.id: replace(body, pose=Pose([0.0, 0.0, HOLDING.lift_m]) * body.pose)}
    for name, one in ((first, second), (second, first)):
        around = cell.planner_among(name, {one: lifts[one][-1]}, lifted)
        gripper = around.kinematics.arm.gripper
        around.check(lifts[name][-1], Load(command_of(hands[name].width, gripper), fingers_may_touch=parts))
    return PlanWithBoth(target, hands, reaches, lifts)


def _reach(planner: MotionPlanner, begun: JointPath, hand: OneHand, parts: list[str]) -> JointPath:
    """The way of an arm to its hold."""
    opening = command_of(approach_opening(hand.width, planner.kinematics.arm.gripper), planner.kinematics.arm.gripper)
    reach = planner.move(begun.end, hand.way.before, Load(opening), then=[hand.way.grasp, hand.way.lifted])
    near = Load(opening, fingers_may_touch=parts, speed=CAREFUL_SPEED_SHARE)
    return begun.then(reach).then(planner.line(reach.end, hand.way.grasp, near))


def _rise(cell: Workcell, arm: str, start: np.ndarray, hand: OneHand) -> np.ndarray:
    """(k, n) joints of an arm at each height of the lift."""
    kinematics = kinematics_of(cell.world.arms[arm].arm)
    found, grasp = [start], hand.way.grasp
    for height in np.linspace(0, HOLDING.lift_m, round(HOLDING.lift_m / SETTINGS.step_m) + 1)[1:]:
        q = kinematics.ik(Pose(grasp.p + [0.0, 0.0, height], grasp.q), found[-1], attempts=0)
        if q is None:
            raise MotionFailed("an arm cannot follow the straight line up")
        found.append(q)
    if max(np.abs(b - a).max() for a, b in pairwise(found)) > MOTION.largest_jump_rad:
        raise MotionFailed("an arm cannot follow the straight line up")
    return np.array(found)


def carry_out_with_both(cell: Workcell, plan: PlanWithBoth) -> WorldState:
    """Let one arm after the other take hold, and both rise at the same time; the state in the air.

    Raises:
        TaskFailed: fingers close on nothing or lose it, or something else is touched.
    """
    world, target = cell.world, plan.target
    cell.take(target.id)
    first, second = plan.hands
    _take_hold(cell, plan, first)
    plan = _as_it_stands(cell, plan, second)
    _take_hold(cell, plan, second)
    _feel(cell, plan)
    cell.carry_out_together(target.id, _rising(cell, plan))
    world.step(round(HOLDING.held_s * PHYSICS_HZ))
    _feel(cell, plan)
    return world.state()


def _take_hold(cell: Workcell, plan: PlanWithBoth, arm: str) -> None:
    """Bring one arm to its hold, and close its fingers."""
    control, hand = cell.world.arms[arm], plan.hands[arm]
    allowed = at_rest(hand.way.grasp, plan.target.id, {*cell.beside(plan.target.id), *plan.hands} - {arm})
    control.command_gripper(command_of(approach_opening(hand.width, control.arm.gripper), control.arm.gripper))
    cell.carry_out(arm, plan.reaches[arm], allowed)
    control.grip(0.0)


def _as_it_stands(cell: Workcell, plan: PlanWithBoth, arm: str) -> PlanWithBoth:
    """The plan with the hold of the second arm on the object as the first hand has moved it.

    Raises:
        TaskFailed: the second arm does not reach it there.
    """
    stood, stands = (_on_table(pose) for pose in (plan.target.pose, cell.object(plan.target.id).pose))
    moved = stands * stood.inverse()
    way = plan.hands[arm].way
    way = PickWay(moved * way.before, moved * way.grasp, moved * way.lifted)
    hand = replace(plan.hands[arm], way=way)
    parts = cell.parts(plan.target.id, *cell.contents(plan.target.id))
    with failing_at("grasp"):
        reach = _reach(cell.planner(arm), cell.begun(arm), hand, parts)
        lift = _rise(cell, arm, reach.end, hand)
    return replace(
        plan,
        hands={**plan.hands, arm: hand},
        reaches={**plan.reaches, arm: reach},
        lifts={**plan.lifts, arm: lift},
    )


def _on_table(pose: Pose) -> Pose:
    """Place and heading of an object, without its height and lean."""
    return Pose.from_yaw([*pose.p[:2], 0.0], pose.yaw)


def _rising(cell: Workcell, plan: PlanWithBoth) -> dict[str, Trajectory]:
    """Trajectories of both arms that pass the same heights at the same time."""
    arms = [cell.world.arms[name].arm for name in plan.hands]
    path = np.hstack([plan.lifts[name] for name in plan.hands])
    whole = time_optimal(path, PHYSICS_HZ, ArmsTogether(tuple(arms)), SETTINGS.speed)
    ends = np.cumsum([len(arm.joints) for arm in arms])[:-1]
    split = (np.split(values, ends, axis=1) for values in (whole.q, whole.velocity, whole.acceleration))
    return {name: Trajectory(*part) for name, *part in zip(plan.hands, *split, strict=True)}


def _feel(cell: Workcell, plan: PlanWithBoth) -> None:
    """Check that both hands hold something.

    Raises:
        TaskFailed: one does not.
    """
    for name in plan.hands:
        if cell.world.arms[name].empty:
            raise TaskFailed("grasp", f"{plan.target.id} is not between the fingers of the {name} arm")
