"""Which way an object that was found faces, when its model can be drawn: drawings all around it, compared with the
target.

The template of an object lies on a prism, and what is tall, round or lying is none: turned, its picture is wrong, and
the heading with it. A drawing of the model has no such error: its photometric alignment with the target says how far
to move, and what that leaves says how well the heading fits.
"""

from __future__ import annotations

from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from vcage.base.geometry import Camera, Pose, box_corners, wrap_angle
from vcage.schema.asset import PhysicalModel
from vcage.schema.scene import ObjectRecord
from vcage.sim.drawer import Drawer, Window
from vcage.vision.colour import LabImage
from vcage.vision.photometric_alignment import MOTION_PRIOR, align
from vcage.vision.symmetry import smallest_turn

HEADINGS = 12
"""Headings around the circle that are drawn first, small."""

SMALL, LARGE = 64, 96
"""Largest side of these drawings, and of those that decide, pixels."""

STARTS, SMALL_ROUNDS, SMALL_SPREAD = 5, 2, 1.1
"""Of the small drawings so many follow where the target asks them to move, for so many rounds, while they leave no more
than this times what the best leaves: the true heading may begin behind others."""

LARGE_STARTS, ROUNDS, SPREAD = 3, 2, 1.05
"""Of these so many are drawn large and follow on, for so many rounds, while they leave no more than this times what the
best leaves."""

PROBE = 0.15
"""Turn to either side that is tried at the end, radians: slopes of colours see no farther than a few pixels."""

SPARE = 6
"""Pixels of the camera around the object in a window."""

TELLING = 5e-4
"""How much less than another heading the best leaves, if it is no mere symmetry of it."""

HELPED = 0.999
"""A motion that leaves more than this share of what was left before did not help."""

FARTHEST = 0.03
"""How far an object may be moved from where it was found, metres."""

QUARTER = np.array([[0.0, -1.0], [1.0, 0.0]])
"""Turns by a right angle."""


@dataclass(frozen=True, eq=False)
class _Compared:
    """A pose (x, y, turn), what its drawing leaves unexplained, and the motion that the difference asks for."""

    pose: np.ndarray
    left: float
    motion: np.ndarray


@dataclass(frozen=True)
class _Part:
    """The part of the target around the object.

    Args:
        window: where it is.
        target: (side, side, 4) Lab and salience of the target there.
        motions: (side, side, 2, 3) how far its pixels move with x, y and the angle about where the object was found.
    """

    window: Window
    target: np.ndarray
    motions: np.ndarray


class Comparison:
    """A target picture and one object that is drawn over it.

    Args:
        image: the target in the colours of the source.
        record: the object; where and how it stood in the source.
        camera: took the source.
        drawer: draws it.
        place: (2,) where it was found, metres.
    """

    def __init__(self, image: LabImage, record: ObjectRecord, camera: Camera, drawer: Drawer, place: np.ndarray):
        self._view, self._record, self._camera, self._drawer = image, record, camera, drawer
        standing = record.pose.pose()
        self._attitude, self._height = Pose(q=standing.q), float(standing.p[2])
        model = drawer.model(record.id)
        self._lower, self._size = reach(model, standing, camera, place)
        middle = (record.aabb[0][2] + record.aabb[1][2]) / 2
        at = np.array([*place, middle])
        near = camera.project(at + np.array([[0, 0, 0], [1e-3, 0, 0], [0, 1e-3, 0]]))
        self._pivot, self._along = near[0], (near[1:] - near[0]).T / 1e-3
        self._place = place
        self._turning = self._along @ QUARTER @ np.linalg.inv(self._along)
        self._parts: dict[int, _Part] = {}

    def step(self, side: int) -> int:
        """Pixels of the camera to one of a drawing that is no larger than ``side``."""
        return max(1, int(np.ceil(self._size / side)))

    def at(self, pose: np.ndarray, step: int) -> _Compared:
        """The object drawn at a pose (3,): x, y, turn since the source; every so many pixels of the camera."""
        part = self._part(step)
        standing = Pose.from_yaw([*pose[:2], self._height], float(pose[2])) * self._attitude
        drawing = self._drawer.draw(self._record.id, standing, self._camera, part.window)
        motions = part.motions.copy()
        motions[..., 2] += self._turning @ self._along @ (self._place - pose[:2]) / step
        left, motion = align(drawing, part.target, motions, step, self._camera.focal)
        return _Compared(pose, left, motion)

    def moved(self, compared: _Compared) -> np.ndarray:
        """(3,) the pose that the difference asks for, no farther than :data:`FARTHEST` from where it was found."""
        pose = compared.pose + np.clip(compared.motion, -2 * MOTION_PRIOR, 2 * MOTION_PRIOR)
        away = pose[:2] - self._place
        pose[:2] = self._place + away * min(1.0, FARTHEST / max(float(np.linalg.norm(away)), 1e-9))
        return pose

    def _part(self, step: int) -> _Part:
        if step not in self._parts:
            side = 16 * int(np.ceil(self._size / step / 16))
            left, top = (round(float(x)) for x in self._lower + (self._size - side * step) / 2)
            v, u = np.mgrid[:side, :side]
            pixels = np.stack([left + (u + 0.5) * step, top + (v + 0.5) * step], axis=-1)
            motions = np.empty((side, side, 2, 3), np.float32)
            motions[..., :2] = self._along
            motions[..., 2] = (pixels - self._pivot) @ self._turning.T
            self._parts[step] = _Part(
                Window(left, top, side, step), self._view.sample(pixels, float(step)), motions / step
            )
        return self._parts[step]


def reach(model: PhysicalModel | None, standing: Pose, camera: Camera, place: np.ndarray) -> tuple[np.ndarray, float]:
    """((2,) left and top, side) of the square that holds an object at any heading at a place, pixels."""
    if model is None:
        raise ValueError("an object without a model cannot be drawn")
    corners = Pose(q=standing.q).apply(box_corners(model.lower, model.upper))
    radius = np.linalg.norm(corners[:, :2], axis=1).max()
    heights = corners[:, 2].min(), corners[:, 2].max()
    around = np.array([[x, y, z] for x in (-radius, radius) for y in (-radius, radius) for z in heights])
    pixels = camera.project(around + [*place, standing.p[2]])
    low, high = pixels.min(axis=0) - SPARE, pixels.max(axis=0) + SPARE
    side = float((high - low).max())
    return (low + high - side) / 2, side


def settle_heading(
    image: LabImage, record: ObjectRecord, camera: Camera, pose: np.ndarray, drawer: Drawer, order: int
) -> np.ndarray:
    """The pose near a found one (4,), at any heading, at which the object's drawing is most like the target.

    Args:
        image: the target in the colours of the source.
        record: the object.
        camera: took the source.
        drawer: has a model of it.
        order: n-fold symmetry seen from above (0 round); of headings that look the same by it the smallest turn is
            taken, unless the drawings say otherwise: a reference picture from above hides what a slant shows.
    """
    comparison = Comparison(image, record, camera, drawer, pose[:2].copy())
    small, large = comparison.step(SMALL), comparison.step(LARGE)
    turns = pose[2] + np.arange(HEADINGS) * 2 * np.pi / HEADINGS
    around = sorted((comparison.at(np.array([*pose[:2], turn]), small) for turn in turns), key=attrgetter("left"))
    near = _follow(comparison, around[:STARTS], small, SMALL_ROUNDS, SMALL_SPREAD)
    few = [one for one in near[:LARGE_STARTS] if one.left <= SPREAD * near[0].left]
    if large != small:
        few = [comparison.at(one.pose, large) for one in few]
    best = _probed(comparison, _follow(comparison, few, large, ROUNDS, SPREAD)[0], large)
    turn = best.pose[2]
    if order != 1:
        other = comparison.at(np.array([*best.pose[:2], smallest_turn(turn, order)]), large)
        if best.left > min(other.left, comparison.at(comparison.moved(other), large).left) - TELLING:
            turn = other.pose[2]
    return np.array([*best.pose[:2], wrap_angle(turn), pose[3]])


def _follow(comparison: Comparison, starts: list[_Compared], step: int, rounds: int, spread: float) -> list[_Compared]:
    """Starts after they moved where the target asks for as long as that helped; the best first, without those that
    leave more than ``spread`` times what the best leaves, and without those that met a better one."""
    found, still = starts, []
    for _ in range(rounds):
        pairs = [(one, comparison.at(comparison.moved(one), step)) for one in found if one not in still]
        still += [old for old, new in pairs if new.left > HELPED * old.left]
        found = sorted([*still, *(new for old, new in pairs if old not in still)], key=attrgetter("left"))
        found = _apart([one for one in found if one.left <= spread * found[0].left])
    return found


def _apart(found: list[_Compared]) -> list[_Compared]:
    """Those whose headings no better one is near."""
    kept: list[_Compared] = []
    for one in found:
        if all(abs(wrap_angle(one.pose[2] - other.pose[2])) > PROBE for other in kept):
            kept.append(one)
    return kept


def _probed(comparison: Comparison, best: _Compared, step: int) -> _Compared:
    """The best of a pose and those that a turn to either side leads to."""
    for probe in (-PROBE, PROBE):
        turned = comparison.at(best.pose + [0, 0, probe], step)
        nearer = comparison.at(comparison.moved(turned), step)
        if nearer.left < best.left:
            best = _follow(comparison, [nearer], step, ROUNDS, SPREAD)[0]
    return best
