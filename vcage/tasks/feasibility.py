"""Feasible before simulated: the checks of a transfer by geometry and inverse kinematics.

A transfer is an object with one contact point and a receptacle with one functional point. Each check compares
a measurement with its limit, in a readable sentence.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from vcage.base.geometry import Pose
from vcage.base.memory import remembered
from vcage.schema.asset import ContactPoint, FunctionalPoint
from vcage.schema.robot import Gripper, Robot
from vcage.schema.subtasks import Check
from vcage.sim.bodies import Body
from vcage.sim.collision import meets_box
from vcage.sim.kinematics import ArmKinematics
from vcage.tasks.access import headroom
from vcage.tasks.findings import Feasibility, Report, hand_check, reach_check, travel
from vcage.tasks.grasps import GRASPING, GraspPose, approach_opening, hand_boxes
from vcage.tasks.hand_poses import hand_poses
from vcage.tasks.primitives.pick import lift_heights, reached_lift, transfer_heights
from vcage.tasks.primitives.place_way import DROP, largest_drop, place_way, reached_place
from vcage.tasks.scene_objects import REMEMBERED, Obstacles, SceneObject, SolidBox, first_met
from vcage.tasks.slots import nested_bottom
from vcage.tasks.state import resting_point
from vcage.tasks.workplace import Workplace


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
        checks, height, path = [hand_check("around", where, blocked)], heights[0], None
        if blocked is None:
            height, path = reached_lift(kinematics, target, grasp, heights)
            checks.append(reach_check("reach_grasp", where, path is not None, arm))
        found[height].append(Pick(grasp, checks, path))
    return [pick for some in found.values() for pick in some]


def hand_has_room(target: SceneObject, others: Sequence[SceneObject], robot: Robot) -> bool:
    """True if some hand gets to an object by some contact point without touching another; arms are not examined."""
    grippers = {arm.gripper.model_dump_json(): arm.gripper for arm in robot.arms.values()}
    return any(
        met is None
        for contact in target.asset.annotation.carrying_points
        for gripper in grippers.values()
        for _, met in _hands(target, contact.id, tuple(others), gripper)
    )


@remembered(REMEMBERED)
def _hands(
    target: SceneObject, contact_id: int, others: tuple[SceneObject, ...], gripper: Gripper
) -> list[tuple[GraspPose, str | None]]:
    """The poses of a hand at a contact point, whichever arm has it, each with the phrase of the object in its way."""
    contact = target.asset.annotation.contact_point(contact_id)
    width = target.asset.grasp_width(contact)
    poses = hand_poses(target, contact, gripper)
    opening = approach_opening(width, gripper)
    holder = next((o for o in others if o.id == target.record.container), None)
    beside = [o for o in others if o is not holder]
    walls = [] if holder is None else _walls_around(target, holder)
    found = []
    for grasp in poses:
        hand = [SolidBox(part, grasp.pose) for part in hand_boxes(gripper, opening, min(width, opening))]
        met = holder if any(part.overlaps(wall) for part in hand for wall in walls) else first_met(hand, beside)
        phrase = None if met is None else met.record.phrase
        if phrase is None and palm_meets(target, grasp, gripper):
            phrase = f"{target.record.phrase} itself"
        found.append((grasp, phrase))
    return found


def palm_meets(target: SceneObject, grasp: GraspPose, gripper: Gripper) -> bool:
    """True if the palm of a hand that takes an object overlaps the object: a tilted hand may lie across it."""
    *_, (lower, upper) = hand_boxes(gripper, gripper.max_width)
    at = grasp.pose * Pose((lower + upper) / 2)
    return meets_box(Body(target.asset.model, target.pose, target.joints), upper - lower, at)


def _walls_around(thing: SceneObject, holder: SceneObject) -> list[SolidBox]:
    """Boxes of a receptacle that may block a hand taking an object out of it or off it."""
    where = resting_point(thing, holder)
    return holder.boxes if where is None else holder.around(where.id)


@dataclass(frozen=True)
class Transfer:
    """One thing to try: grasp an object, and bring it somewhere.

    Args:
        target, contact: the object, and the point at which it is grasped.
        where: the place in words.
        poses: alternatives of the object at the place, in the world.
        around: boxes in reach of the hand there.
        over: heights that the object must clear on its way there, z in metres.
        others: all other objects, with their parts open as needed then.
        drop_m: how far it may fall there.
    """

    target: SceneObject
    contact: ContactPoint
    where: str
    poses: Sequence[Pose]
    around: Sequence[SolidBox]
    over: Sequence[float]
    others: tuple[SceneObject, ...]
    drop_m: float = DROP.most_m

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
        return cls(target, contact, where, poses, around, over, tuple(others), largest_drop(receptacle, point.id))

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
        """z's of the object's frame at which its bottom clears the others on its way to the place, the highest first,
        metres."""
        rise = self.target.asset.stands.inverse().p[2]
        return tuple(height + rise for height in transfer_heights(self.others, table_height, self.over))

    @cached_property
    def obstacles(self) -> Obstacles:
        """Boxes in reach of the hand there, built only when a grasp gets that far."""
        return Obstacles(self.around)


def transfers(
    target: SceneObject,
    receptacle: SceneObject | None,
    point: int | None,
    poses: Sequence[Pose],
    others: Sequence[SceneObject],
) -> dict[int, Transfer]:
    """The transfers of an object to a place, by the id of each contact point by which it can be carried.

    Args:
        target, poses, others: as of a transfer.
        receptacle, point: where it goes; None for the table.
    """
    contacts = target.asset.annotation.carrying_points
    if receptacle is None or point is None:
        return {c.id: Transfer.onto_table(target, c, poses, others) for c in contacts}
    there = receptacle.asset.annotation.functional_point(point)
    return {c.id: Transfer.into(target, c, receptacle, there, poses, others) for c in contacts}


def fits(target: SceneObject, receptacle: SceneObject, point: FunctionalPoint) -> Check:
    """Check that the object's footprint goes into the opening, straight or turned by a quarter, or that it nests.

    Args:
        target: the object to put there.
        receptacle: its target.
        point: functional point of the receptacle.
    """
    target = target.as_standing
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
    if spare < 0 and (bottom := nested_bottom(target, receptacle, point)) is not None:
        deep = receptacle.asset.opening(point).rim - bottom
        message = f"{target.record.phrase} ({needs}) nests {deep * 100:.1f} cm deep in {receptacle.record.phrase}"
        return Check(name="fits", passed=True, value=deep, limit=0.0, message=message)
    verb = "fits" if spare >= 0 else "does not fit"
    return Check(
        name="fits",
        passed=spare >= 0,
        value=spare,
        limit=0.0,
        message=f"{target.record.phrase} ({needs}) {verb} {point.holds} {receptacle.record.phrase} ({room})",
    )


def opens_wide_enough(target: SceneObject, contact: ContactPoint, kinematics: Mapping[str, ArmKinematics]) -> Check:
    """Check that a gripper opens wider than the material at the contact point.

    Args:
        target: the object that is held.
        contact: contact point of the target.
        kinematics: by arm.
    """
    width = target.asset.grasp_width(contact)
    limit = max(k.arm.gripper.max_width for k in kinematics.values()) - GRASPING.grip_room_m
    verb = "can" if width <= limit else "cannot"
    return Check(
        name="opening",
        passed=width <= limit,
        value=width,
        limit=limit,
        message=f"the gripper {verb} hold {target.record.phrase} at {contact.name!r}, {width * 100:.1f} cm wide",
    )


def examine(transfer: Transfer, workplace: Workplace) -> Feasibility:
    """All checks of a transfer, cheap ones first; stops at the first that no arm passes.

    Args:
        transfer: to try.
        workplace: with the arms that may do it.
    """
    wide = opens_wide_enough(transfer.target, transfer.contact, workplace.kinematics)
    if not wide.passed:
        return Feasibility([wide], [])
    height = workplace.ground.height
    reports = {arm: _examine_arm(transfer, arm, k, height) for arm, k in workplace.kinematics.items()}
    return Feasibility.of_arms(transfer.contact.id, [wide], reports)


def feasible(ways: Mapping[int, Transfer], workplace: Workplace) -> Iterator[Feasibility]:
    """Yield the findings of those transfers that an arm can do.

    Args:
        ways: by contact point.
        workplace: with the arms that may do it.
    """
    return filter(lambda found: found.feasible, (examine(way, workplace) for way in ways.values()))


def _examine_arm(transfer: Transfer, arm: str, kinematics: ArmKinematics, table_height: float) -> Report:
    """The checks of one arm, and the score of its straightest pick that works."""
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
    checks = [*pick.checks, _drop_check(transfer, drop)]
    if drop > transfer.drop_m:
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
    """The drop and joint path to the first of some poses to which the arm can bring the object, from the greatest
    possible height; else the least drop and None."""
    width = transfer.target.asset.grasp_width(transfer.contact)
    drops = []
    for height, goal in product(heights, goals):
        way = place_way(held, goal, transfer.obstacles, kinematics.arm.gripper, width, height)
        drops.append(way.drop)
        reached = reached_place(kinematics, way, start) if way.drop <= transfer.drop_m else None
        if reached is not None:
            return way.drop, reached[1]
    return min(drops), None


def _drop_check(transfer: Transfer, drop: float) -> Check:
    phrase, passed = transfer.target.record.phrase, drop <= transfer.drop_m
    how = "is let go" if passed else "can only be let go"
    message = f"{phrase} {how} {drop * 100:.1f} cm above {transfer.where}"
    return Check(name="drop", passed=passed, value=drop, limit=transfer.drop_m, message=message)
