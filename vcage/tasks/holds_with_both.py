"""Two hands on one object: holds at two places of it, one for each arm, and the joints with which both lift it.

Geometry and inverse kinematics only: the planner finds obstacles.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, islice, product

import numpy as np

from vcage.base.geometry import Pose
from vcage.schema.asset import ContactPoint
from vcage.schema.robot import Gripper
from vcage.sim.kinematics import ArmKinematics, follow
from vcage.sim.motion import MotionFailed
from vcage.tasks.grasps import approach_opening, hand_boxes
from vcage.tasks.hand_poses import hand_poses
from vcage.tasks.holding import SETTINGS as HOLDING
from vcage.tasks.meeting import SETTINGS as MEETING
from vcage.tasks.meeting import balance_of, places_along
from vcage.tasks.primitives.pick import PickWay
from vcage.tasks.scene_objects import SceneObject, SolidBox, first_met


@dataclass(frozen=True)
class HoldsWithBothSettings:
    """Settings of the search for two holds.

    Args:
        pairs: of places on the object that are examined, the most even first.
        poses: of each hand at its place, the straightest first.
        least_apart_m: between the middles of the two hands.
        tilts_rad: turns of a hand about its closing axis, in this order: one that leans by 40° squeezes a lug out of
            its fingers, and the object jumps.
    """

    pairs: int = 12
    poses: int = 6
    least_apart_m: float = 0.08
    tilts_rad: tuple[float, ...] = tuple(np.radians([0.0, 20.0, -20.0]))


SETTINGS = HoldsWithBothSettings()


@dataclass(frozen=True)
class OneHand:
    """One arm's part of a lift with both.

    Args:
        contact: its place on the object.
        way: poses of the gripper: before the grasp, at it, and lifted.
        width: material between the fingers, metres.
    """

    contact: ContactPoint
    way: PickWay
    width: float


Hands = Mapping[str, OneHand]
"""By arm."""


def places_for_both(thing: SceneObject, gripper: Gripper) -> list[tuple[ContactPoint, ContactPoint]]:
    """Pairs of places at which two hands can hold an object, those about its middle first, and of these the widest."""
    asset = thing.asset
    places = list(places_along(asset, asset.annotation.carrying_points, gripper))
    middle, found = balance_of(asset)[:2], []
    for one, other in combinations(places, 2):
        a, b = np.array(one.position), np.array(other.position)
        apart = float(np.linalg.norm((b - a)[:2]))
        if apart >= SETTINGS.least_apart_m:
            uneven = float(np.linalg.norm((a + b)[:2] / 2 - middle))
            found.append((round(uneven, 2), -apart, len(found), (one, other)))
    return [pair for *_, pair in sorted(found)]


def ends_for_both(thing: SceneObject, gripper: Gripper) -> list[ContactPoint]:
    """The places of the pairs that are examined, once each."""
    pairs = places_for_both(thing, gripper)[: SETTINGS.pairs]
    return list({place.model_dump_json(): place for pair in pairs for place in pair}.values())


def holds_with_both(
    thing: SceneObject, arms: Mapping[str, ArmKinematics], others: Sequence[SceneObject] = ()
) -> Iterator[Hands]:
    """Ways of two arms to hold and lift an object together; at least one.

    Args:
        thing: where it stands.
        arms: two of them, by name.
        others: things around it that no hand may touch.

    Raises:
        MotionFailed: there is none.
    """
    left, right = sorted(arms, key=lambda name: float(arms[name].arm.base.pose().p[0]))
    gripper = arms[left].arm.gripper
    pairs = places_for_both(thing, gripper)
    if not pairs:
        raise MotionFailed(f"two hands have no room on {thing.record.phrase}")
    known: dict[tuple[str, tuple[float, ...]], list[OneHand]] = {}

    def ways(arm: str, place: ContactPoint) -> list[OneHand]:
        key = arm, tuple(np.round(place.position, 4).tolist())
        if key not in known:
            known[key] = list(islice(_ways(thing, arms[arm], place, others), SETTINGS.poses))
        return known[key]

    found = False
    for pair in pairs[: SETTINGS.pairs]:
        mine, other = sorted(pair, key=lambda place: float(thing.pose.apply([place.position])[0][0]))
        for a, b in product(ways(left, mine), ways(right, other)):
            if not _meet(a, b, gripper):
                found = True
                yield {left: a, right: b}
    if not found:
        raise MotionFailed(f"the two arms do not both get hold of {thing.record.phrase} to lift it together")


def _ways(
    thing: SceneObject, kinematics: ArmKinematics, place: ContactPoint, others: Sequence[SceneObject]
) -> Iterator[OneHand]:
    """The ways of an arm to hold an object at a place and lift it straight up."""
    gripper, width = kinematics.arm.gripper, thing.asset.grasp_width(place)
    opening = approach_opening(width, gripper)
    for grasp in hand_poses(thing, place, gripper, SETTINGS.tilts_rad):
        hand = [SolidBox(box, grasp.pose) for box in hand_boxes(gripper, opening, min(width, opening))]
        if first_met(hand, others) is not None:
            continue
        before = Pose(grasp.pose.p - gripper.approach * grasp.pose.rotation()[:, 2], grasp.pose.q)
        way = PickWay(before, grasp.pose, Pose(grasp.pose.p + [0.0, 0.0, HOLDING.lift_m], grasp.pose.q))
        if follow(kinematics, [way.before, way.grasp, way.lifted], kinematics.home) is not None:
            yield OneHand(place, way, width)


def _meet(one: OneHand, other: OneHand, gripper: Gripper) -> bool:
    """True if the two hands would overlap, with the room that they keep from each other."""
    boxes = []
    for hand in (one, other):
        opening = approach_opening(hand.width, gripper)
        boxes.append([SolidBox(box, hand.way.grasp) for box in hand_boxes(gripper, opening, hand.width)])
    room = np.array([[-MEETING.apart_m], [MEETING.apart_m]])
    return any(SolidBox(a.bounds + room, a.pose).overlaps(b) for a, b in product(*boxes))
