"""Feasible before simulated: everything about a transfer that geometry and inverse kinematics can tell.

A transfer is an object with one contact point and a receptacle with one functional point. Each check says what
was measured against what is allowed, in a sentence that a person can read.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise, product
from typing import Literal

import numpy as np

from vcage.base.geometry import Pose
from vcage.base.memory import remembered
from vcage.schema.asset import ContactPoint, FunctionalPoint
from vcage.schema.goals import part_words
from vcage.schema.robot import Gripper, Robot
from vcage.schema.subtasks import Check, Grasp
from vcage.sim.joints import carried_by, joint_positions
from vcage.sim.kinematics import ArmKinematics, follow
from vcage.tasks.access import headroom
from vcage.tasks.grasps import GRIP_ROOM, GraspPose, approach_opening, grasp_poses, hand_boxes
from vcage.tasks.primitives.handles import Handle, operating_ways
from vcage.tasks.primitives.pick import lift_heights, reached_lift, transfer_heights
from vcage.tasks.primitives.place_way import MAX_DROP, place_way, reached_place
from vcage.tasks.scene_objects import REMEMBERED, Obstacles, SceneObject, SolidBox, first_met
from vcage.tasks.truth import resting_point


@dataclass(frozen=True)
class Transfer:
    """One thing to try: grasp an object, and bring it somewhere.

    Args:
        target, contact: what is grasped, and where.
        where: the place in words.
        poses: of the object at the place, in the world: any of them does.
        around: what the hand may meet there.
        over: heights that the object must be above when it is brought there, z in metres.
        others: all other objects, those with parts that must be open as they are then.
    """

    target: SceneObject
    contact: ContactPoint
    where: str
    poses: Sequence[Pose]
    around: Sequence[SolidBox]
    over: Sequence[float]
    others: tuple[SceneObject, ...]

    @classmethod
    def into(
        cls,
        target: SceneObject,
        contact: ContactPoint,
        receptacle: SceneObject,
        point: FunctionalPoint,
        poses: Sequence[Pose],
        others: Sequence[SceneObject],
    ) -> Transfer:
        """To a functional point of a receptacle.

        Args:
            target, contact, poses: as of the transfer.
            receptacle, point: where it goes.
            others: all other objects, the receptacle among them.
        """
        neighbours = [box for o in others if o.id != receptacle.id for box in o.boxes]
        around = [*receptacle.around(point.id), *neighbours]
        where, over = f"{point.name!r} of {receptacle.record.phrase}", [receptacle.rim(point.id)]
        return cls(target, contact, where, poses, around, over, tuple(others))

    @classmethod
    def onto_table(
        cls, target: SceneObject, contact: ContactPoint, poses: Sequence[Pose], others: Sequence[SceneObject]
    ) -> Transfer:
        """To a place on the table.

        Args:
            target, contact, poses, others: as of the transfer.
        """
        around = [box for o in others for box in o.boxes]
        return cls(target, contact, "its place on the table", poses, around, (), tuple(others))

    def heights(self, table_height: float) -> tuple[float, ...]:
        """z's that the object's bottom may keep on its way to the place, the highest first, metres."""
        return transfer_heights(self.others, table_height, self.over)

    @cached_property
    def obstacles(self) -> Obstacles:
        """What the hand may meet there, looked at only when a grasp leads that far."""
        return Obstacles(self.around)


Report = tuple[Sequence[Check], float | None]
"""The checks of one arm up to the first that failed, and the score of its motion; None where it cannot do it."""


@dataclass(frozen=True)
class Feasibility:
    """The checks of the best arm up to the first that failed, and the arms that can do it, best first."""

    checks: list[Check]
    grasps: list[Grasp]

    @classmethod
    def of_arms(cls, contact: int, before: Sequence[Check], reports: Mapping[str, Report]) -> Feasibility:
        """What the arms can do, with the checks of the best; where none can, of the one that came furthest.

        Args:
            contact: id of the contact point; of a push its direction.
            before: checks that do not depend on the arm, all of them passed.
            reports: by arm, at least one.
        """
        scores = {arm: score for arm, (_, score) in reports.items() if score is not None}
        grasps = [Grasp(contact=contact, arm=arm, score=round(score, 4)) for arm, score in scores.items()]
        grasps.sort(key=lambda grasp: (-grasp.score, grasp.arm))
        told = grasps[0].arm if grasps else max(reports, key=lambda arm: _progress(reports[arm][0]))
        return cls([*before, *reports[told][0]], grasps)

    @property
    def feasible(self) -> bool:
        """Whether some arm can do it."""
        return bool(self.grasps)

    @property
    def reason(self) -> str:
        """Why it is not feasible; empty when it is."""
        return "" if self.feasible else next(c.message for c in reversed(self.checks) if not c.passed)


def best_first(findings: Sequence[Feasibility]) -> tuple[list[Grasp], list[Check]]:
    """All grasps of feasible findings, the best first, and the checks of the best."""
    grasps = [grasp for finding in findings for grasp in finding.grasps]
    grasps.sort(key=lambda grasp: (-grasp.score, grasp.contact, grasp.arm))
    return grasps, next(f for f in findings if grasps[0] in f.grasps).checks


def fits(target: SceneObject, receptacle: SceneObject, point: FunctionalPoint) -> Check:
    """Whether the object's footprint goes into the opening, straight or turned by a quarter.

    Args:
        target: what is put.
        receptacle: where.
        point: functional point of the receptacle.
    """
    height, room = float(target.asset.size[2]), headroom(receptacle, point)
    if height > room:
        message = (
            f"{target.record.phrase} ({height * 100:.1f} cm tall) does not fit under what closes {point.name!r} of "
            f"{receptacle.record.phrase} ({room * 100:.1f} cm)"
        )
        return Check(name="fits", passed=False, value=room - height, limit=0.0, message=message)
    size, opening = target.asset.footprint, np.array(receptacle.asset.opening(point).size)
    spare = max(float(np.min(opening - size)), float(np.min(opening - size[::-1])))
    needs = f"{size[0] * 100:.1f} × {size[1] * 100:.1f} cm"
    room = f"{opening[0] * 100:.1f} × {opening[1] * 100:.1f} cm"
    verb = "fits" if spare >= 0 else "does not fit"
    return Check(
        name="fits",
        passed=spare >= 0,
        value=spare,
        limit=0.0,
        message=f"{target.record.phrase} ({needs}) {verb} {point.holds} {receptacle.record.phrase} ({room})",
    )


def opens_wide_enough(target: SceneObject, contact: ContactPoint, kinematics: Mapping[str, ArmKinematics]) -> Check:
    """Whether a gripper opens wider than the material at the contact point.

    Args:
        target: what is held.
        contact: contact point of the target.
        kinematics: by arm.
    """
    width = target.asset.grasp_width(contact)
    limit = max(k.arm.gripper.max_width for k in kinematics.values()) - GRIP_ROOM
    verb = "can" if width <= limit else "cannot"
    return Check(
        name="opening",
        passed=width <= limit,
        value=width,
        limit=limit,
        message=f"the gripper {verb} hold {target.record.phrase} at {contact.name!r}, {width * 100:.1f} cm wide",
    )


def examine(transfer: Transfer, kinematics: Mapping[str, ArmKinematics], table_height: float) -> Feasibility:
    """All checks of a transfer, cheap ones first; stops at the first that no arm passes.

    Args:
        kinematics: by arm.
        table_height: z of the table top, metres.
    """
    wide = opens_wide_enough(transfer.target, transfer.contact, kinematics)
    if not wide.passed:
        return Feasibility([wide], [])
    reports = {arm: _examine_arm(transfer, arm, k, table_height) for arm, k in kinematics.items()}
    return Feasibility.of_arms(transfer.contact.id, [wide], reports)


def _progress(checks: Sequence[Check]) -> tuple[int, bool]:
    """How far an arm came: how many checks it passed, and whether it is long enough for the place to be looked at."""
    return sum(check.passed for check in checks), any(check.name == "drop" for check in checks)


def examine_operation(
    thing: SceneObject,
    contact: ContactPoint,
    target: float,
    others: Sequence[SceneObject],
    kinematics: Mapping[str, ArmKinematics],
) -> Feasibility:
    """Whether some arm can bring the part that a contact point is on to a joint position.

    Args:
        thing: the object, its joints where they are before.
        contact: on the part.
        target: position of the joint, metres or radians.
        others: the other objects of the scene.
        kinematics: by arm.
    """
    width = thing.asset.grasp_width(contact)
    handle = Handle(contact, thing.asset.model, thing.pose, joint_positions(thing.asset.model, thing.joints), width)
    met = _part_meets(thing.moved(thing.pose, tuple(handle.joints_at(target))), str(contact.link), others)
    if met is not None:
        message = f"{met} is in the way of the {part_words(str(contact.link))} of {thing.record.phrase}"
        return Feasibility([Check(name="way_free", passed=False, message=message)], [])
    wide = opens_wide_enough(thing, contact, kinematics)
    if contact.use == "grasp" and not wide.passed:
        return Feasibility([wide], [])
    reports = {arm: _examine_ways(handle, thing, target, others, arm, k) for arm, k in kinematics.items()}
    return Feasibility.of_arms(contact.id, [wide] if contact.use == "grasp" else [], reports)


def _examine_ways(
    handle: Handle,
    thing: SceneObject,
    target: float,
    others: Sequence[SceneObject],
    arm: str,
    kinematics: ArmKinematics,
) -> Report:
    """The checks of the way that came furthest, and the score of the first that an arm can follow."""
    gripper = kinematics.arm.gripper
    where = f"{handle.contact.name!r} of {thing.record.phrase}"
    furthest: list[Check] = []
    for way in operating_ways(handle, target, gripper, thing.box.bottom):
        blocked = _hand_meets(way.grasp, way.opening, handle.width, others, gripper)
        free = f"the hand has room at {where}"
        message = free if blocked is None else f"{blocked} is in the way of the hand at {where}"
        checks = [Check(name="way_free", passed=blocked is None, message=message)]
        reached = None if blocked else follow(kinematics, [way.before, way.grasp], kinematics.home)
        moved = None
        if not blocked:
            checks.append(reach_check("reach_grasp", where, reached is not None, arm))
        if reached is not None:
            moved = follow(kinematics, [*way.motion, way.after], reached[-1])
            checks.append(reach_check("reach_motion", f"{where} all along its way", moved is not None, arm))
        if reached is not None and moved is not None:
            return checks, -travel([kinematics.home, *reached, *moved, kinematics.home])
        furthest = checks if len(checks) > len(furthest) else furthest
    return furthest, None


def _examine_arm(transfer: Transfer, arm: str, kinematics: ArmKinematics, table_height: float) -> Report:
    """What one arm can do.

    Args:
        transfer: what is tried.
        arm: its name.
        kinematics: of the arm.
        table_height: z of the table top, metres.
    """
    found: dict[str, Check] = {}
    heights = transfer.heights(table_height)
    for pick in picks(transfer.target, transfer.contact.id, transfer.others, arm, kinematics, table_height):
        checks, score = _examine_place(transfer, arm, kinematics, pick, heights)
        if score is not None:
            return checks, score  # the straightest pose that works: later ones only tilt more, or lift less
        for check in checks:
            if check.name not in found or check.passed:
                found[check.name] = check
    return list(found.values()), None


@dataclass(frozen=True)
class Pick:
    """A grasp, its checks, and the joints on the way to it and up again; None when it cannot be done."""

    grasp: GraspPose
    checks: list[Check]
    path: list[np.ndarray] | None


@remembered(REMEMBERED)
def picks(
    target: SceneObject,
    contact_id: int,
    others: tuple[SceneObject, ...],
    arm: str,
    kinematics: ArmKinematics,
    table_height: float,
) -> list[Pick]:
    """The ways of an arm to take an object by a contact point, the straightest first, wherever it then goes; those come
    last with which the arm does not lift it above all others."""
    gripper = kinematics.arm.gripper
    heights = lift_heights(target, others, table_height)
    where = f"{target.asset.annotation.contact_point(contact_id).name!r} of {target.record.phrase}"
    found: dict[float, list[Pick]] = {height: [] for height in heights}
    for grasp, blocked in _hands(target, contact_id, others, gripper):
        free = f"the hand has room around {where}"
        message = free if blocked is None else f"{blocked} is in the way of the hand at {where}"
        checks = [Check(name="way_free", passed=blocked is None, message=message)]
        height, path = heights[0], None
        if blocked is None:
            height, path = reached_lift(kinematics, target, grasp, heights)
            checks.append(reach_check("reach_grasp", where, path is not None, arm))
        found[height].append(Pick(grasp, checks, path))
    return [pick for some in found.values() for pick in some]


@remembered(REMEMBERED)
def _hands(
    target: SceneObject, contact_id: int, others: tuple[SceneObject, ...], gripper: Gripper
) -> list[tuple[GraspPose, str | None]]:
    """The poses of a hand at a contact point, whichever arm has it, each with the phrase of what is in its way."""
    contact = target.asset.annotation.contact_point(contact_id)
    width = target.asset.grasp_width(contact)
    poses = grasp_poses(target.pose, contact, gripper, target.box.bottom)
    opening = approach_opening(width, gripper)
    holder = next((o for o in others if o.id == target.record.container), None)
    beside = [o for o in others if o is not holder]
    walls = [] if holder is None else _walls_around(target, holder)
    found = []
    for grasp in poses:
        hand = [SolidBox(part, grasp.pose) for part in hand_boxes(gripper, opening, min(width, opening))]
        met = holder if any(part.overlaps(wall) for part in hand for wall in walls) else first_met(hand, beside)
        found.append((grasp, None if met is None else met.record.phrase))
    return found


def hand_has_room(target: SceneObject, others: Sequence[SceneObject], robot: Robot) -> bool:
    """Check if some hand gets to an object by some contact point without touching another; arms are not looked at."""
    grippers = {arm.gripper.model_dump_json(): arm.gripper for arm in robot.arms.values()}
    return any(
        met is None
        for contact in target.asset.annotation.carrying_points
        for gripper in grippers.values()
        for _, met in _hands(target, contact.id, tuple(others), gripper)
    )


def _walls_around(thing: SceneObject, holder: SceneObject) -> list[SolidBox]:
    """What of a receptacle may be in the way of a hand that takes a thing out of it or off it."""
    where = resting_point(thing, holder)
    return holder.boxes if where is None else holder.around(where.id)


def _examine_place(
    transfer: Transfer, arm: str, kinematics: ArmKinematics, pick: Pick, heights: Sequence[float]
) -> Report:
    """The checks of a grasp and of the way on from there, and the score of the whole; None when it cannot be done."""
    if pick.path is None:
        return pick.checks, None
    held = pick.grasp.in_object
    goals = [g for g in transfer.poses if not kinematics.too_far(Pose([*g.p[:2], heights[-1]], g.q) * held)]
    if not goals:
        return [*pick.checks, reach_check("reach_place", transfer.where, False, arm)], None
    drop, path = _best_place(transfer, kinematics, held, goals, heights, pick.path[-1])
    checks = [*pick.checks, _drop_check(transfer.target.record.phrase, transfer.where, drop)]
    if drop > MAX_DROP:
        return checks, None
    checks.append(reach_check("reach_place", transfer.where, path is not None, arm))
    if path is None:
        return checks, None
    return checks, -travel([kinematics.home, *pick.path, *path, kinematics.home])


def _best_place(
    transfer: Transfer,
    kinematics: ArmKinematics,
    held: Pose,
    goals: Sequence[Pose],
    heights: Sequence[float],
    start: np.ndarray,
) -> tuple[float, list[np.ndarray] | None]:
    """The drop and joint path of the first of some poses that the arm can bring the object to, from as high as it
    reaches; else the least drop and None."""
    width = transfer.target.asset.grasp_width(transfer.contact)
    drops = []
    for height, goal in product(heights, goals):
        way = place_way(held, goal, transfer.obstacles, kinematics.arm.gripper, width, height)
        drops.append(way.drop)
        reached = reached_place(kinematics, way, start) if way.drop <= MAX_DROP else None
        if reached is not None:
            return way.drop, reached[1]
    return min(drops), None


def _hand_meets(
    pose: Pose, opening: float, width: float, others: Sequence[SceneObject], gripper: Gripper
) -> str | None:
    """The phrase of the first object that the hand would touch while its fingers go from ``width`` to ``opening``."""
    hand = [SolidBox(part, pose) for part in hand_boxes(gripper, opening, min(width, opening))]
    met = first_met(hand, others)
    return None if met is None else met.record.phrase


def _part_meets(thing: SceneObject, link: str, others: Sequence[SceneObject]) -> str | None:
    """The phrase of the first object that a part, or what moves with it, would touch where it is now, its contents
    apart."""
    parts = [thing.part_box(name) for name in carried_by(thing.asset.model, link)]
    met = first_met(parts, [o for o in others if o.record.container != thing.id])
    return None if met is None else met.record.phrase


def travel(path: Sequence[np.ndarray]) -> float:
    """Length of a joint path, radians: the largest joint change of each leg, which rules how long it takes."""
    return float(sum(np.abs(b - a).max() for a, b in pairwise(path)))


def _drop_check(phrase: str, where: str, drop: float) -> Check:
    passed = drop <= MAX_DROP
    how = "is let go" if passed else "can only be let go"
    message = f"{phrase} {how} {drop * 100:.1f} cm above {where}"
    return Check(name="drop", passed=passed, value=drop, limit=MAX_DROP, message=message)


def reach_check(
    name: Literal["reach_grasp", "reach_place", "reach_motion"], where: str, reached: bool, arm: str
) -> Check:
    verb = "reaches" if reached else "does not reach"
    return Check(name=name, passed=reached, message=f"the {arm} arm {verb} {where}")
