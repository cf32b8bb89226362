"""The heading of an object that was found: drawings of its model at headings all around, compared with the target.

The template of an object lies on a prism. For a tall, round or lying object, the picture of the turned prism is wrong,
and so is the heading by the pose score. A drawing of the model has no such error. Its photometric alignment with the
target gives a motion, and the residual is the score of the heading.
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

QUARTER_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])


@dataclass(frozen=True)
class Pass:
    """Drawings of one size that follow the motions suggested by the target.

    Args:
        side_px: largest side of a drawing.
        starts: poses that are followed.
        spread: a pose is given up when its residual exceeds this multiple of the best one's; the true heading may
            begin behind others.
        rounds: motions of a pose.
    """

    side_px: int
    starts: int
    spread: float
    rounds: int = 2


@dataclass(frozen=True)
class HeadingSettings:
    """Effort and limits of the search for a heading.

    Args:
        headings: around the circle, drawn first.
        small, large: the pass that compares all of these, and the pass that decides.
        probe_rad: turn to either side that is tried at the end: slopes of colours reach a few pixels only.
        spare_px: pixels of the camera around the object in a drawing.
        least_advantage: margin by which the best residual must beat that of a symmetric heading.
        helpful_share: a motion helped if the residual after it is at most this share of the one before.
        farthest_m: an object may move this far from its found place.
    """

    headings: int = 12
    small: Pass = Pass(side_px=64, starts=5, spread=1.1)
    large: Pass = Pass(side_px=96, starts=3, spread=1.05)
    probe_rad: float = 0.15
    spare_px: int = 6
    least_advantage: float = 5e-4
    helpful_share: float = 0.999
    farthest_m: float = 0.03


SETTINGS = HeadingSettings()


@dataclass(frozen=True, eq=False)
class _Compared:
    """A pose (x, y, turn), the residual of its drawing, and the motion that the difference suggests."""

    pose: np.ndarray
    residual: float
    motion: np.ndarray


@dataclass(frozen=True)
class _Part:
    """The part of the target around the object.

    Args:
        window: its place in the camera's picture.
        target: (side, side, 4) Lab and salience of the target there.
        motions: (side, side, 2, 3) motion of its pixels with x, y and the angle about the object's found place.
    """

    window: Window
    target: np.ndarray
    motions: np.ndarray


class Comparison:
    """A target picture and one object that is drawn over it.

    Args:
        image: the target in the colours of the source.
        camera: of both pictures.
        record: the object and its pose in the source.
        drawer: draws it.
        place: (2,) its found place, metres.
    """

    def __init__(self, image: LabImage, camera: Camera, record: ObjectRecord, drawer: Drawer, place: np.ndarray):
        self._view, self._record, self._camera, self._drawer = image, record, camera, drawer
        standing = record.pose.pose()
        self._attitude, self._height = Pose(q=standing.q), float(standing.p[2])
        model = drawer.model(record.id)
        self._lower, self._size = _square_around(model, standing, camera, place)
        middle = (record.aabb[0][2] + record.aabb[1][2]) / 2
        at = np.array([*place, middle])
        near = camera.project(at + np.array([[0, 0, 0], [1e-3, 0, 0], [0, 1e-3, 0]]))
        self._pivot, self._along = near[0], (near[1:] - near[0]).T / 1e-3
        self._place = place
        self._turning = self._along @ QUARTER_TURN @ np.linalg.inv(self._along)
        self._parts: dict[int, _Part] = {}

    def step(self, side: int) -> int:
        """Pixels of the camera to one of a drawing that is no larger than ``side``."""
        return max(1, int(np.ceil(self._size / side)))

    def at(self, pose: np.ndarray, step: int) -> _Compared:
        """Compare the object drawn at a pose (3,): x, y, turn since the source; at every ``step``-th camera pixel."""
        part = self._part(step)
        standing = Pose.from_yaw([*pose[:2], self._height], float(pose[2])) * self._attitude
        drawing = self._drawer.draw(self._record.id, standing, self._camera, part.window)
        motions = part.motions.copy()
        motions[..., 2] += self._turning @ self._along @ (self._place - pose[:2]) / step
        residual, motion = align(drawing, part.target, motions, step, self._camera.focal)
        return _Compared(pose, residual, motion)

    def moved(self, compared: _Compared) -> np.ndarray:
        """(3,) the pose that the difference suggests, within the farthest distance from the found place."""
        pose = compared.pose + np.clip(compared.motion, -2 * MOTION_PRIOR, 2 * MOTION_PRIOR)
        away = pose[:2] - self._place
        pose[:2] = self._place + away * min(1.0, SETTINGS.farthest_m / max(float(np.linalg.norm(away)), 1e-9))
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
            target = self._view.sample(pixels, float(step))
            self._parts[step] = _Part(Window(left, top, side, step), target, motions / step)
        return self._parts[step]


def _square_around(
    model: PhysicalModel | None, standing: Pose, camera: Camera, place: np.ndarray
) -> tuple[np.ndarray, float]:
    """((2,) left and top, side) of the square that contains an object at any heading at a place, pixels."""
    if model is None:
        raise ValueError("an object without a model cannot be drawn")
    corners = Pose(q=standing.q).apply(box_corners(model.lower, model.upper))
    radius = np.linalg.norm(corners[:, :2], axis=1).max()
    heights = corners[:, 2].min(), corners[:, 2].max()
    around = np.array([[x, y, z] for x in (-radius, radius) for y in (-radius, radius) for z in heights])
    pixels = camera.project(around + [*place, standing.p[2]])
    low, high = pixels.min(axis=0) - SETTINGS.spare_px, pixels.max(axis=0) + SETTINGS.spare_px
    side = float((high - low).max())
    return (low + high - side) / 2, side


def settle_heading(
    image: LabImage, camera: Camera, record: ObjectRecord, pose: np.ndarray, drawer: Drawer, order: int
) -> np.ndarray:
    """The pose near a found one (4,), at any heading, at which the object's drawing is most like the target.

    Args:
        image: the target in the colours of the source.
        camera: of both pictures.
        record: the object.
        pose: where it was found.
        drawer: has a model of it.
        order: n-fold symmetry seen from above (0 round). Of symmetric headings the smallest turn is taken, unless the
            drawings tell them apart: a slanted view shows sides that the reference picture from above hides.
    """
    comparison = Comparison(image, camera, record, drawer, pose[:2].copy())
    small, large = comparison.step(SETTINGS.small.side_px), comparison.step(SETTINGS.large.side_px)
    turns = pose[2] + np.arange(SETTINGS.headings) * 2 * np.pi / SETTINGS.headings
    around = sorted((comparison.at(np.array([*pose[:2], turn]), small) for turn in turns), key=attrgetter("residual"))
    near = _follow(comparison, around[: SETTINGS.small.starts], small, SETTINGS.small)
    few = _within(near[: SETTINGS.large.starts], SETTINGS.large.spread)
    if large != small:
        few = [comparison.at(one.pose, large) for one in few]
    best = _probed(comparison, _follow(comparison, few, large, SETTINGS.large)[0], large)
    turn = best.pose[2]
    if order != 1:
        other = comparison.at(np.array([*best.pose[:2], smallest_turn(turn, order)]), large)
        moved = comparison.at(comparison.moved(other), large)
        if best.residual > min(other.residual, moved.residual) - SETTINGS.least_advantage:
            turn = other.pose[2]
    return np.array([*best.pose[:2], wrap_angle(turn), pose[3]])


def _follow(comparison: Comparison, starts: list[_Compared], step: int, way: Pass) -> list[_Compared]:
    """The starts, each moved as the target suggests for as long as that helped; the best first.

    Poses far behind the best, and poses that meet a better one, are left out.
    """
    found, settled = starts, []
    for _ in range(way.rounds):
        pairs = [(one, comparison.at(comparison.moved(one), step)) for one in found if one not in settled]
        settled += [old for old, new in pairs if new.residual > SETTINGS.helpful_share * old.residual]
        moved = [new for old, new in pairs if old not in settled]
        found = _apart(_within(sorted([*settled, *moved], key=attrgetter("residual")), way.spread))
    return found


def _within(found: list[_Compared], spread: float) -> list[_Compared]:
    """The poses, the best first, whose residual is at most ``spread`` times the best one's."""
    return [one for one in found if one.residual <= spread * found[0].residual]


def _apart(found: list[_Compared]) -> list[_Compared]:
    """The poses, the best first, without those whose heading is close to a better one's."""
    distinct: list[_Compared] = []
    for one in found:
        if all(abs(wrap_angle(one.pose[2] - other.pose[2])) > SETTINGS.probe_rad for other in distinct):
            distinct.append(one)
    return distinct


def _probed(comparison: Comparison, best: _Compared, step: int) -> _Compared:
    """The best of a pose and the poses that a turn to either side leads to."""
    for probe in (-SETTINGS.probe_rad, SETTINGS.probe_rad):
        turned = comparison.at(best.pose + [0, 0, probe], step)
        nearer = comparison.at(comparison.moved(turned), step)
        if nearer.residual < best.residual:
            best = _follow(comparison, [nearer], step, SETTINGS.large)[0]
    return best
