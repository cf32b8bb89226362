"""Vessels that are tipped: their ways over a container, and what comes out of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from vcage.base.geometry import Pose
from vcage.schema.asset import ContactPoint
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import lying_on
from vcage.tasks.stowing import open_point


@dataclass(frozen=True)
class PouringSettings:
    """The way of a vessel over a container.

    Args:
        lean_rad: how far it is tipped at the end: past level by more than walls slope inwards.
        step_rad: between two poses of the way.
        above_m: heights of its lip over the container at the end, in the order to try: a hand below it needs room.
        clear_m: least height of all of it over the container on the way.
        directions: in which it is tipped, and sides of it over which all rolls out.
        flight_m: how far what rolls out flies before it is in the container.
        rim_m: what is at most this much lower than the rim belongs to the lip.
        with_fingers: least |cosine| of the angle between a side and the axis along which fingers close: about that axis
            a cup turned between them by 24 degrees.
        below_m: fingers this much below the rim are not in the way of what rolls over it.
        ways_of_a_hold: that are planned at most: what is in the way of some is in the way of the others.
        beside_share: others are at most at this share of the lip's distance from the middle, seen in its direction.
    """

    lean_rad: float = float(np.radians(120.0))
    step_rad: float = float(np.radians(9.0))
    above_m: tuple[float, ...] = (0.06, 0.12)
    clear_m: float = 0.02
    directions: int = 12
    flight_m: float = 0.02
    rim_m: float = 0.004
    with_fingers: float = 0.8
    below_m: float = 0.02
    ways_of_a_hold: int = 3
    beside_share: float = 0.3


SETTINGS = PouringSettings()


def balls_in(vessel: SceneObject, others: Iterable[SceneObject]) -> list[SceneObject]:
    """The balls among others that lie in a vessel."""
    return [o for o in lying_on(vessel, others) if o.asset.ball_radius is not None]


def left_in(vessel: SceneObject, balls: Iterable[SceneObject]) -> list[SceneObject]:
    """The balls whose middle is between the walls of a vessel, however that leans."""
    lower, upper = vessel.asset.bounds
    middles = ((ball, vessel.pose.inverse().apply(ball.aabb.mean(axis=0))) for ball in balls)
    return [ball for ball, middle in middles if np.all((lower <= middle) & (middle <= upper))]


def pouring_ways(vessel: SceneObject, target: SceneObject, contact: ContactPoint) -> Iterator[list[Pose]]:
    """Ways of a vessel over a container: its poses, upright at first, and tipped as far as it goes at the end.

    Its lip stays over one spot, so that all falls there.

    Args:
        vessel: as it stands; open at the top.
        target: the container, open at the top.
        contact: where the vessel is held: no finger is in the way of what rolls out.
    """
    middle = _middle(target)
    turns = [middle * Pose.from_yaw([0, 0, 0], turn) * middle.inverse() for turn in _turns()]
    for side, above in product(lips(vessel, contact), SETTINGS.above_m):
        way = _way(vessel, target, side, SETTINGS.lean_rad, above)
        yield from ([turn * pose for pose in way] for turn in turns)


def _middle(target: SceneObject) -> Pose:
    """The middle of a container's opening in the world, at z = 0."""
    point = open_point(target.asset)
    assert point is not None, "a container is open at the top"
    x, y, _ = target.pose.apply([*target.asset.opening(point).centre, 0.0])
    return Pose([x, y, 0.0])


def lips(vessel: SceneObject, contact: ContactPoint) -> list[np.ndarray]:
    """(2,) sides of a vessel, in its frame, over which it can be poured where it is held at a contact point.

    Those come first at which it turns least between the fingers.
    """
    around = [np.array([np.cos(turn), np.sin(turn)]) for turn in _turns()]
    sides = [side for side in around if suits(vessel, contact, side)]
    return sorted(sides, key=lambda side: -round(float(abs(side @ contact.closing[:2])), 3))


def _turns() -> list[float]:
    """Angles all around, radians."""
    return [2 * np.pi * number / SETTINGS.directions for number in range(SETTINGS.directions)]


def suits(vessel: SceneObject, contact: ContactPoint, side: np.ndarray) -> bool:
    """True where a vessel that is held at a contact point does not turn between the fingers when it is tipped over a
    side (2,), and they are not where balls roll over its lip."""
    lip = _lip(vessel, side)
    if abs(side @ contact.closing[:2]) < SETTINGS.with_fingers:
        return False
    if contact.position[2] <= lip[2] - SETTINGS.below_m:
        return True
    half = vessel.asset.grasp_width(contact) / 2 * np.array(contact.closing[:2])
    fingers = np.array(contact.position[:2]) + [half, -half]
    return bool((fingers @ side).max() <= SETTINGS.beside_share * lip[:2] @ side)


def tipped_to(way: Sequence[Pose]) -> np.ndarray:
    """(2,) side of a vessel, in its frame, over which a way tips it."""
    towards = way[0].rotation().T @ (way[-1].rotation()[:, 2] * [1.0, 1.0, 0.0])
    return towards[:2] / np.linalg.norm(towards[:2])


def _lip(vessel: SceneObject, side: np.ndarray) -> np.ndarray:
    """(3,) outer edge of a vessel's rim at a side (2,), in its frame."""
    point = open_point(vessel.asset)
    assert point is not None, "a vessel is open at the top"
    opening = vessel.asset.opening(point)
    corners = np.concatenate([piece.vertices for piece in vessel.asset.pieces])
    rim = corners[corners[:, 2] >= opening.rim - SETTINGS.rim_m, :2] - opening.centre
    return np.append(opening.centre + (rim @ side).max() * side, opening.rim)


def _way(vessel: SceneObject, target: SceneObject, side: np.ndarray, lean: float, above: float) -> list[Pose]:
    """The poses of a vessel that is tipped along x in the world, about its lip at a side (2,) of its own."""
    x, y, _ = _middle(target).p
    top, lip = float(target.around_boxes[1, 2]), _lip(vessel, side)
    upright = Pose.from_yaw([0, 0, 0], -float(np.arctan2(side[1], side[0])))
    corners = upright.apply(np.concatenate([piece.vertices for piece in vessel.asset.pieces]) - lip)
    found: list[Pose] = []
    for angle in np.linspace(0, lean, 1 + int(np.ceil(lean / SETTINGS.step_rad))):
        rotation = Pose(q=[np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0]) * upright
        low = float((np.sin(angle) * corners[:, 0] - np.cos(angle) * corners[:, 2]).max())
        height = top + max(above, SETTINGS.clear_m + low)
        found.append(Pose(np.array([x - SETTINGS.flight_m, y, height]) - rotation.apply(lip), rotation.q))
    return found
