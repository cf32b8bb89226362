"""Push: an object that no hand can hold is moved along the table, straight, by two finger tips behind one of its faces.

The open fingers, their closing axis across the push, touch the face beside its middle: a flat face lies against both,
a round one between them, and the object goes straight on without turning.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.errors import UnknownName
from vcage.base.geometry import Pose, frame_from_axes, wrap_angle
from vcage.schema.plan import TABLE
from vcage.schema.robot import Gripper
from vcage.sim.collision import Held
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import JointPath, Load
from vcage.tasks.grasps import command_of, hand_boxes
from vcage.tasks.scene_objects import SceneObject, SolidBox
from vcage.tasks.touching import Allowance
from vcage.tasks.workcell import CAREFUL_SPEED_SHARE, TaskFailed, Workcell, failing_at, first_reasons


@dataclass(frozen=True)
class PushSettings:
    """The motion of a push, and limits from which on the object got out of hand.

    Args:
        speed_share: share of the speed limit while an object is pushed: it must not run ahead of the fingers.
        gap_m: between the face and the finger tips that have come down behind it.
        over_table_m: between the finger tips and the table.
        leans_deg: turns about the closing axis that take the palm away from the object: it stands out before
            the fingers.
        spread_share: share of the face's width that the fingers are apart, where they open so wide.
        away_m: how far behind the face the hand is drawn back before it goes up.
        over_object_m: between the tips and the top of the object when the hand comes and goes.
        corrections: further pushes along the line where the object did not come far enough.
        position_tolerance_m: shortfall of a push that is not corrected.
        off_m: an object farther from its target than this got out of control,
        turned_rad: or that was turned by more,
        tipped_rad: or tipped.
    """

    speed_share: float = 0.25
    gap_m: float = 0.02
    over_table_m: float = 0.004
    leans_deg: tuple[float, ...] = (0.0, 35.0, 45.0)
    spread_share: float = 0.5
    away_m: float = 0.03
    over_object_m: float = 0.03
    corrections: int = 4
    position_tolerance_m: float = 0.004
    off_m: float = 0.03
    turned_rad: float = np.radians(15)
    tipped_rad: float = np.radians(10)


SETTINGS = PushSettings()


@dataclass(frozen=True)
class PushWay:
    """Gripper poses of a push, in order.

    Args:
        above: over where the hand comes down.
        before: behind the face.
        touch: at the face.
        pushed: at the face when the object is there.
        after: drawn back.
        up: over that.
        opening: of the fingers, metres.
    """

    above: Pose
    before: Pose
    touch: Pose
    pushed: Pose
    after: Pose
    up: Pose
    opening: float


@dataclass(frozen=True)
class PushPlan:
    """A push that an arm can do.

    Args:
        arm: that does it.
        way: poses of the gripper.
        goal: of the object, in the world.
        reach: to behind the face.
        push: from there.
    """

    arm: str
    way: PushWay
    goal: Pose
    reach: JointPath
    push: JointPath


def push_ways(thing: SceneObject, goal: Pose, gripper: Gripper) -> Iterator[PushWay]:
    """The ways to push an object straight from where it stands to ``goal``, the hand straight down first.

    Each comes twice, with the gripper flipped by 180° about its approach. Left out is what brings the palm into the
    object.

    Args:
        thing: where it stands, upright.
        goal: object frame in the world.
    """
    way = (goal.p - thing.pose.p) * [1.0, 1.0, 0.0]
    along = way / np.linalg.norm(way)
    across = np.array([-along[1], along[0], 0.0])
    outline = thing.outline
    beside = outline @ across[:2]
    width, middle = np.ptp(beside), (beside.min() + beside.max()) / 2 * across + (outline @ along[:2]).min() * along
    opening = min(gripper.max_width, SETTINGS.spread_share * float(width))
    rise = max(gripper.approach, thing.box.top - thing.box.bottom + SETTINGS.over_object_m)
    x, tip = gripper.finger_width / 2, gripper.tip_depth
    for lean in np.radians(SETTINGS.leans_deg):
        ahead, below = x * np.cos(lean) + tip * np.sin(lean), x * np.sin(lean) + tip * np.cos(lean)
        at = middle - along * ahead
        at[2] = thing.box.bottom + SETTINGS.over_table_m + below
        approach = np.sin(lean) * along - [0.0, 0.0, np.cos(lean)]
        if SolidBox(hand_boxes(gripper, opening)[-1], frame_from_axes(at, approach, across)).overlaps(thing.box):
            continue
        for closing in (across, -across):
            touch = frame_from_axes(at, approach, closing)
            before, pushed = _shifted(touch, -SETTINGS.gap_m * along), _shifted(touch, way)
            after, up = _shifted(pushed, -SETTINGS.away_m * along), np.array([0.0, 0.0, rise])
            yield PushWay(_shifted(before, up), before, touch, pushed, after, _shifted(after, up), opening)


def plan_push(cell: Workcell, thing: SceneObject, goal: Pose, arms: Sequence[str]) -> PushPlan:
    """The first free way that one of ``arms`` can push an object straight to a pose.

    Args:
        cell: as it stands.
        thing: where it stands.
        goal: object frame in the world.
        arms: in the order in which they are tried.

    Raises:
        TaskFailed: there is none.
        UnknownName: there is no such arm.
    """
    reasons: list[str] = []
    for arm in arms:
        if arm not in cell.world.arms:
            raise UnknownName("arm", arm, cell.world.arms)
        planner = cell.planner(arm)
        for way in push_ways(thing, goal, planner.kinematics.arm.gripper):
            try:
                return _plan(cell, planner, arm, thing, goal, way)
            except MotionFailed as error:
                reasons.append(f"{arm} arm: {error.message}")
    message = f"no way to push {thing.record.phrase} can be planned: {first_reasons(reasons)}"
    raise TaskFailed("plan", message, exhausted=True)


def _plan(cell: Workcell, planner: MotionPlanner, arm: str, thing: SceneObject, goal: Pose, way: PushWay) -> PushPlan:
    begun, opening = cell.begun(arm), command_of(way.opening, planner.kinematics.arm.gripper)
    then = [way.before, way.touch, way.pushed, way.after, way.up]
    reach = planner.move(begun.end, way.above, Load(opening), then=then)
    down = planner.line(reach.end, way.before, Load(opening, speed=CAREFUL_SPEED_SHARE))
    near = planner.line(down.end, way.touch, Load(opening, ignore=cell.parts(thing.id), speed=SETTINGS.speed_share))
    push = planner.line(near.end, way.pushed, _pushing(thing, way.touch, opening))
    return PushPlan(arm, way, goal, begun.then(reach).then(down), near.then(push))


def _pushing(thing: SceneObject, hand: Pose, opening: float) -> Load:
    """The object goes with the hand as if it were held, and must touch nothing."""
    held = Held(thing.id, thing.asset.model, hand.inverse() * thing.pose, thing.joints)
    return Load(opening, held=held, speed=SETTINGS.speed_share)


def carry_out_push(cell: Workcell, thing: SceneObject, plan: PushPlan) -> None:
    """Push, with corrections where the object did not come far enough; the next motion starts with the retreat.

    Args:
        cell: as it stands.
        thing: where it stands.
        plan: of the push.

    Raises:
        TaskFailed: the object is not where it was pushed to, has turned or tipped, or the hand cannot be drawn back.
    """
    control = cell.world.arms[plan.arm]
    opening = command_of(plan.way.opening, control.arm.gripper)
    control.command_gripper(opening)
    allowed = [
        Allowance("hand", frozenset([thing.id])),
        Allowance("fingers", frozenset([TABLE])),
        Allowance("load", cell.beside(thing.id)),
    ]
    cell.carry_out(plan.arm, plan.reach, allowed)
    cell.carry_out(plan.arm, plan.push, allowed)
    along = plan.way.pushed.p - plan.way.touch.p
    along /= np.linalg.norm(along)
    done, last, stopped = plan.push.end, plan.way.pushed, ""
    for _ in range(SETTINGS.corrections):
        now = cell.object(thing.id)
        missing = float((plan.goal.p - now.pose.p) @ along)
        if missing < SETTINGS.position_tolerance_m:
            break
        here, last = last, _shifted(last, missing * along)
        try:
            further = cell.planner(plan.arm).line(done, last, _pushing(now, here, opening))
        except MotionFailed as error:
            stopped = f", and the hand could not go on: {error.message}"
            break
        cell.carry_out(plan.arm, further, allowed)
        done = further.end
    away = Load(opening, ignore=cell.parts(thing.id), speed=CAREFUL_SPEED_SHARE)
    with failing_at("place"):
        cell.put_off(plan.arm, cell.planner(plan.arm).follow(done, [plan.way.after, plan.way.up], away), allowed)
    _confirm(cell.object(thing.id), thing, plan.goal, stopped)


def _confirm(now: SceneObject, before: SceneObject, goal: Pose, stopped: str) -> None:
    """Check that an object is at the end of its push, and stands upright as before.

    Args:
        now, before: the object after the push and before it.
        goal: object frame in the world.
        stopped: clause on why it was not pushed farther, appended to the reason; empty where nothing stopped the hand.

    Raises:
        TaskFailed: it is not, or does not.
    """
    phrase = now.record.phrase
    tipped = float(np.arccos(np.clip(now.pose.rotation()[:, 2] @ before.pose.rotation()[:, 2], -1, 1)))
    turned = abs(float(wrap_angle(now.pose.yaw - goal.yaw)))
    off = float(np.linalg.norm((now.pose.p - goal.p)[:2]))
    if tipped > SETTINGS.tipped_rad:
        raise TaskFailed("place", f"{phrase} tipped by {np.degrees(tipped):.0f}° when it was pushed")
    if turned > SETTINGS.turned_rad:
        raise TaskFailed("place", f"{phrase} turned by {np.degrees(turned):.0f}° when it was pushed")
    if off > SETTINGS.off_m:
        raise TaskFailed("place", f"{phrase} is {off * 100:.1f} cm from where it was pushed to{stopped}")


def _shifted(pose: Pose, way: np.ndarray) -> Pose:
    return Pose(pose.p + way, pose.q)
