"""Meetings of two hands on one object in the air: the hold of the second beside the first, and the place.

Geometry and inverse kinematics only: the planner finds obstacles.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice, product
from typing import Literal

import numpy as np
from scipy.spatial import ConvexHull

from vcage.base.geometry import Pose, frame_from_axes
from vcage.base.memory import remembered
from vcage.objects.asset import Asset
from vcage.schema.asset import ContactPoint
from vcage.schema.robot import Gripper
from vcage.sim.kinematics import ArmKinematics
from vcage.sim.motion import MotionFailed
from vcage.tasks.grasps import GRASPING, approach_opening, hand_boxes
from vcage.tasks.hand_poses import hand_poses
from vcage.tasks.primitives.grip import SETTINGS as CARRYING
from vcage.tasks.primitives.grip import lever
from vcage.tasks.primitives.pick import transfer_height
from vcage.tasks.scene_objects import REMEMBERED, SceneObject, SolidBox


@dataclass(frozen=True)
class MeetingSettings:
    """Settings of the search for a place where an object changes hands.

    Args:
        step_m: between neighbouring places along an object that the second hand tries.
        steps: to either side of a contact point.
        end_room_m: the object must extend this far beyond the middle of the fingers.
        least_width_m: of material between the fingers.
        leans_rad: turns of the second hand about its closing axis: two hands side by side lean apart.
        apart_m: between two hands on one object.
        wrist_m: from the finger tips back to the wrist.
        holds: of the second hand that are examined.
        meetings: places for each hold at which nothing is in the way.
        ahead_m, above_m: places of the first hand before the middle between the arms' bases, and above it. Arms with
            short wrists meet near their bases and low: there their hands point down.
        turned_deg: headings off the line from one base to the other of the line from the first hand to the second.
            Where wrists turn little, hands meet one behind the other.
    """

    step_m: float = 0.015
    steps: int = 8
    end_room_m: float = 0.012
    least_width_m: float = 0.004
    leans_rad: tuple[float, ...] = tuple(float(np.radians(lean)) for lean in (0, 20, -20, 40, -40, 60, -60))
    apart_m: float = 0.008
    wrist_m: float = 0.18
    holds: int = 16
    meetings: int = 3
    ahead_m: tuple[float, ...] = (0.5, 0.42, 0.58, 0.3, 0.2)
    above_m: tuple[float, ...] = (0.3, 0.4, 0.22, 0.14, 0.08)
    turned_deg: tuple[float, ...] = (0.0, 30.0, -30.0, 60.0, -60.0, 90.0, -90.0, 120.0, -120.0, 150.0, -150.0, 180.0)


SETTINGS = MeetingSettings()


@dataclass(frozen=True)
class Hold:
    """A hand on an object.

    Args:
        in_object: gripper frame in the object frame.
        width: material between the fingers, metres.
    """

    in_object: Pose
    width: float

    def hand(self, gripper: Gripper) -> list[SolidBox]:
        """Boxes that the hand fills while it closes and opens, in the object frame; the palm is first."""
        opening = approach_opening(self.width, gripper)
        return [SolidBox(box, self.in_object) for box in hand_boxes(gripper, opening, self.width)[::-1]]

    def palm(self, gripper: Gripper) -> np.ndarray:
        """(3,) the middle of the palm in the object frame, metres."""
        return self.in_object.apply([0.0, 0.0, -gripper.finger_length - gripper.palm_height / 2])

    @property
    def wrist(self) -> np.ndarray:
        """(3,) in the object frame, metres."""
        return self.in_object.apply([0.0, 0.0, -SETTINGS.wrist_m])


@dataclass(frozen=True)
class Meeting:
    """An object in two hands.

    Args:
        pose: of the object in the world.
        given, taken: how the first and the second hand hold it.
        giving: (n,) joints of the first arm, rad.
        before, taking: (n,) joints of the second arm before its hold and at it, rad.
    """

    pose: Pose
    given: Hold
    taken: Hold
    giving: np.ndarray
    before: np.ndarray
    taking: np.ndarray


class NoMeeting(MotionFailed):
    """An object cannot change hands.

    Args:
        check: the check that it fails.
        message: with the measured values.
    """

    def __init__(self, check: Literal["room_for_hands", "reach_meeting", "reach_place"], message: str):
        super().__init__(message)
        self.check: Literal["room_for_hands", "reach_meeting", "reach_place"] = check


def holds_beside(asset: Asset, given: Hold, contacts: Sequence[ContactPoint], gripper: Gripper) -> list[Hold]:
    """Holds of a second hand on an object beside a first, those nearest to its balance first.

    It takes hold at a contact point, or at another place along the object where the fingers close on material.

    Args:
        asset: of the object.
        given: the first hand.
        contacts: of the object's body.
        gripper: of both.
    """
    first, body = given.hand(gripper), SolidBox(asset.bounds_of(None), Pose())
    found: list[Hold] = []
    for hold in _along(asset, contacts, gripper):
        if np.linalg.norm(hold.palm(gripper) - given.palm(gripper)) < min(gripper.palm_size):
            continue  # these two overlap, whichever way they are turned
        second = hold.hand(gripper)
        grown = [SolidBox(box.bounds + np.array([[-SETTINGS.apart_m], [SETTINGS.apart_m]]), box.pose) for box in second]
        if not second[0].overlaps(body) and not any(a.overlaps(b) for a in grown for b in first):
            found += [hold, Hold(hold.in_object * Pose.from_yaw([0, 0, 0], np.pi), hold.width)]
    balance = balance_of(asset)
    return sorted(found, key=lambda hold: round(float(np.linalg.norm(hold.in_object.p[:2] - balance[:2])), 3))


@remembered(REMEMBERED)
def _holds(thing: SceneObject, given: Hold, gripper: Gripper) -> list[Hold]:
    """:func:`holds_beside` for any hold on an object: a search asks for each possible place."""
    return holds_beside(thing.asset, given, thing.asset.annotation.carrying_points, gripper)


def has_room_beside(thing: SceneObject, giver: Gripper, taker: Gripper) -> bool:
    """True if some hand takes an object by a contact point and leaves room for the other; arms are not examined."""
    return any(
        _holds(thing, Hold(grasp.in_object, thing.asset.grasp_width(contact)), taker)
        for contact in thing.asset.annotation.carrying_points
        for grasp in hand_poses(thing, contact, giver)
    )


def no_room_for_hands(thing: SceneObject, gripper: Gripper) -> str:
    """Say why an object is too short to change hands."""
    long, thick = (100 * x for x in (max(thing.asset.size), gripper.palm_size[0]))
    room = f"it is {long:.1f} cm long, and each is {thick:.1f} cm thick"
    return f"two hands have no room side by side on {thing.record.phrase}: {room}"


def balance_of(asset: Asset) -> np.ndarray:
    """(3,) the object's centre of mass, roughly, in its frame: held near it, the object turns less in the fingers."""
    corners = [piece.vertices for piece in asset.pieces_of(None)]
    return np.average([c.mean(axis=0) for c in corners], axis=0, weights=[ConvexHull(c).volume for c in corners])


def _along(asset: Asset, contacts: Sequence[ContactPoint], gripper: Gripper) -> Iterator[Hold]:
    """Hands at contact points and beside them, along the object, none of them flipped about its approach."""
    for there in places_along(asset, contacts, gripper):
        frame, width = frame_from_axes(there.position, there.approach, there.closing), asset.grasp_width(there)
        for lean in SETTINGS.leans_rad:
            yield Hold(frame * Pose(q=[np.cos(lean / 2), 0, np.sin(lean / 2), 0]), width)


def places_along(asset: Asset, contacts: Sequence[ContactPoint], gripper: Gripper) -> Iterator[ContactPoint]:
    """Contact points, and places beside them along the object where the fingers close on material too."""
    lower, upper = asset.bounds_of(None)
    seen: set[tuple[float, ...]] = set()
    frames = [(c, frame_from_axes(c.position, c.approach, c.closing)) for c in contacts]
    for (contact, frame), steps in product(frames, range(-SETTINGS.steps, SETTINGS.steps + 1)):
        ends = frame.apply([[steps * SETTINGS.step_m + side * SETTINGS.end_room_m, 0.0, 0.0] for side in (-1, 0, 1)])
        there = contact.model_copy(update={"position": tuple(ends[1].tolist())})
        key = (*np.round(ends[1], 3).tolist(), *np.round(frame.q, 2).tolist())
        if key in seen or np.any(ends < lower) or np.any(ends > upper):
            continue
        seen.add(key)
        if SETTINGS.least_width_m <= asset.grasp_width(there) <= gripper.max_width - GRASPING.grip_room_m:
            yield there


def meeting_height(
    thing: SceneObject, given: Hold, gripper: Gripper, others: Sequence[SceneObject], table_height: float
) -> float:
    """z of the hand on an object from which on it hangs above all others, also where it sags, metres."""
    hand = (thing.pose * given.in_object).p
    return (
        transfer_height(others, table_height)
        + float(hand[2])
        - thing.box.bottom
        + CARRYING.sag_share * lever(thing, hand, gripper, given.width)
    )


Suits = Callable[[Hold], None]
"""Raises MotionFailed where an object that is taken by a hold cannot be brought to where it is to go."""

Free = Callable[[Meeting], bool]
"""True if nothing is in the way of the arms where they meet."""


def meetings(
    thing: SceneObject,
    given: Hold,
    arms: tuple[ArmKinematics, ArmKinematics],
    height: float,
    suits: Suits,
    free: Free | None = None,
) -> Iterator[Meeting]:
    """Yield the places where an object can change hands; at least one.

    Args:
        thing: the handed-over object; it is only turned about the vertical.
        given: the hand holding it.
        arms: the giving and the taking arm.
        height: least z of the hands, metres.
        suits: raises where a hold does not suit what comes next.
        free: False for meetings to leave out; without it, all count.

    Raises:
        NoMeeting: there is none.
    """
    taker, phrase = arms[1], thing.record.phrase
    holds = _holds(thing, given, taker.arm.gripper)[: SETTINGS.holds]
    if not holds:
        raise NoMeeting("room_for_hands", no_room_for_hands(thing, taker.arm.gripper))
    found, reached, reasons, giver = False, False, [], _Giver(thing.pose, given, arms, height)

    def is_free(meeting: Meeting) -> bool:
        nonlocal reached
        reached = True
        return free is None or free(meeting)

    for hold in holds:
        try:
            suits(hold)
        except MotionFailed as error:
            reasons.append(error.message)
            continue
        for meeting in islice(filter(is_free, _between(given, hold, giver, taker)), SETTINGS.meetings):
            found = True
            yield meeting
    if found:
        return
    if len(reasons) == len(holds):
        raise NoMeeting("reach_place", f"beside the other hand it cannot be held so that {reasons[0]}")
    why = f"the two arms do not both reach {phrase} between them"
    if reached:
        why = f"where both arms reach {phrase}, one is in the way of the other, or a thing is"
    raise NoMeeting("reach_meeting", why)


class _Giver:
    """The arm that gives an object: the places to which it brings its hand, worked out once for all second hands.

    Args:
        attitude: of the object, which it keeps: as it stands, or as it hangs in the hand.
        given: the arm's hand on the object.
        arms: the giving and the taking arm.
        height: least z of the hand, metres.
    """

    def __init__(self, attitude: Pose, given: Hold, arms: tuple[ArmKinematics, ArmKinematics], height: float):
        self._attitude, self._given, (self._arm, _) = Pose(q=attitude.q), given, arms
        bases = [arm.arm.base.pose() for arm in arms]
        across, forward, middle = bases[1].p - bases[0].p, bases[0].rotation()[:, 0], (bases[0].p + bases[1].p) / 2
        self._across = float(np.arctan2(across[1], across[0]))
        choices = product(*(enumerate(x) for x in (SETTINGS.turned_deg, SETTINGS.above_m, SETTINGS.ahead_m)))
        found: dict[tuple[float, ...], None] = {}
        for (_, turned), (_, above), (_, ahead) in sorted(choices, key=lambda choice: sum(i for i, _ in choice)):
            at = middle + ahead * forward + [0.0, 0.0, above]
            found[(float(np.radians(turned)), *at[:2].tolist(), max(float(at[2]), height))] = None
        self._places = list(found)
        self._known: dict[tuple[float, ...], np.ndarray | None] = {}

    def brings(self, hold: Hold) -> Iterator[tuple[Pose, np.ndarray]]:
        """The object's poses that the arm reaches, and its joints: first those with a second hand on its own side."""
        lean = self._attitude.apply(hold.wrist - self._given.wrist)
        if np.linalg.norm(lean[:2]) < 1e-3:
            return
        own_side = round(self._across - float(np.arctan2(lean[1], lean[0])), 3)
        for turned, *at in self._places:
            turn = Pose.from_yaw([0, 0, 0], own_side + turned) * self._attitude
            pose, key = Pose(at - turn.apply(self._given.in_object.p), turn.q), (own_side, turned, *at)
            if key not in self._known:
                self._known[key] = self._arm.ik(pose * self._given.in_object)
            joints = self._known[key]
            if joints is not None:
                yield pose, joints


def _between(given: Hold, hold: Hold, giver: _Giver, taker: ArmKinematics) -> Iterator[Meeting]:
    """Places between two arms where both reach an object, each by its hold."""
    for pose, giving in giver.brings(hold):
        other = pose * hold.in_object
        before = taker.ik(other * Pose([0.0, 0.0, -taker.arm.gripper.approach]))
        taking = None if before is None else taker.ik(other, before, attempts=0)
        if before is not None and taking is not None:
            yield Meeting(pose, given, hold, giving, before, taking)
