"""Which way an object that was found faces, when its model can be drawn: drawings all around it, compared with the
target.

The crop of an object lies on a prism, and what is tall, round or lying is none: turned, its picture is wrong, and the
heading with it. A drawing of the model has no such error. What is left between it and the target is light, colour and
a small motion, all of which are linear: one robust regression takes them away, says how far to move, and what is left
says how well the heading fits.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from vcage.geometry import Camera, Pose, box_corners, wrap_angle
from vcage.igsc.alignment import LIGHTNESS
from vcage.igsc.crops import View
from vcage.igsc.recover import smallest_turn
from vcage.models.offline.colour import to_lab
from vcage.schema.asset import PhysicalModel
from vcage.schema.scene import ObjectRecord
from vcage.sim.drawer import Drawer, Drawing, Window

HEADINGS = 16
"""Headings around the circle that are drawn first, small."""

SMALL = 32
"""Largest side of these drawings, pixels."""

SMALL_PEAKS = 4
"""Of these the best that are better than their neighbours are moved to where they fit and drawn once more."""

PEAKS = 2
"""Of these the best are drawn at full resolution."""

ROUNDS = 2
"""Drawings at full resolution that follow the motion of the best of them."""

SOFT = 1.0
"""Standard deviation of the blur of drawings, pixels of the camera: image models draw softer than a renderer."""

SPARE = 6
"""Pixels of the camera around the object in a window."""

WEIGHTS = np.float32([LIGHTNESS, 1, 1])
"""Of the channels of Lab."""

COVER = 20.0
"""Colour distance, weighted Lab units, between what is table and what is object."""

SCALE = 15.0
"""Colour distance beyond which a pixel loses its weight."""

LIGHT_PRIOR = np.array([30.0, 0.3, 20.0, 20.0, 20.0, 8.0, 8.0])
"""Standard deviations of what light may do: lightness (offset, factor, along the normal's three parts), the two other
colours (offset)."""

MOTION_PRIOR = np.array([0.005, 0.005, 0.12])
"""Standard deviations of a motion that is taken in one step: x, y (metres), angle (radians)."""

PRIOR = 360.0 / np.concatenate([LIGHT_PRIOR, MOTION_PRIOR]) ** 2
"""What each costs in the regression, in squared colour distances: a standard deviation as much as four far pixels."""

PASSES = 3
"""Rounds of the regression; each weighs the pixels anew."""

INNER = 0.9
"""Coverage of a pixel that is far enough from the outline for its colours to have slopes."""

CLEARLY = 0.9
"""Share of what another heading leaves, below which the best is no mere symmetry of it."""

FARTHEST = 0.03
"""How far an object may be moved from where it was found, metres."""


@dataclass(frozen=True)
class _Compared:
    """A pose (x, y, turn), what its drawing leaves unexplained, and the motion that the difference asks for."""

    pose: np.ndarray
    left: float
    motion: np.ndarray


class Comparison:
    """A target picture and one object that is drawn over it.

    Args:
        view: the target in the colours of the source.
        record: the object; where and how it stood in the source.
        camera: took the source.
        drawer: draws it.
        place: (2,) where it was found, metres.
    """

    def __init__(self, view: View, record: ObjectRecord, camera: Camera, drawer: Drawer, place: np.ndarray):
        self._view, self._record, self._camera, self._drawer = view, record, camera, drawer
        self._standing = record.pose.pose()
        model = drawer.model(record.id)
        self._lower, self._size = reach(model, self._standing, camera, place)
        middle = (record.aabb[0][2] + record.aabb[1][2]) / 2
        at = np.array([*place, middle])
        near = camera.project(at + np.array([[0, 0, 0], [1e-3, 0, 0], [0, 1e-3, 0]]))
        self._pivot, self._along = near[0], (near[1:] - near[0]).T / 1e-3
        self._place = place
        self._windows: dict[int, tuple[Window, np.ndarray]] = {}

    @property
    def small(self) -> int:
        """The step at which a drawing is small."""
        return max(1, int(np.ceil(self._size / SMALL)))

    def at(self, pose: np.ndarray, step: int) -> _Compared:
        """The object drawn at a pose (3,): x, y, turn since the source; every so many pixels of the camera."""
        window, target = self._window(step)
        turn = Pose.from_yaw([0, 0, 0], float(pose[2]))
        position = [float(pose[0]), float(pose[1]), float(self._standing.p[2])]
        standing = Pose(position, (turn * Pose(q=self._standing.q)).q)
        drawing = self._drawer.draw(self._record.id, standing, self._camera, window)
        left, motion = explain(drawing, target, self._motions(window, pose), step)
        return _Compared(pose, left, motion)

    def moved(self, compared: _Compared) -> np.ndarray:
        """(3,) the pose that the difference asks for, no farther than :data:`FARTHEST` from where it was found."""
        pose = compared.pose + np.clip(compared.motion, -2 * MOTION_PRIOR, 2 * MOTION_PRIOR)
        away = pose[:2] - self._place
        pose[:2] = self._place + away * min(1.0, FARTHEST / max(np.linalg.norm(away), 1e-9))
        return pose

    def _window(self, step: int) -> tuple[Window, np.ndarray]:
        """The window around the object and (side, side, 4) Lab and salience of the target there."""
        if step not in self._windows:
            side = 16 * int(np.ceil(self._size / step / 16))
            left, top = (round(float(x)) for x in self._lower + (self._size - side * step) / 2)
            v, u = np.mgrid[:side, :side]
            pixels = np.stack([left + (u + 0.5) * step, top + (v + 0.5) * step], axis=-1)
            self._windows[step] = Window(left, top, side, step), self._view.sample(pixels, float(step))
        return self._windows[step]

    def _motions(self, window: Window, pose: np.ndarray) -> np.ndarray:
        """(side * side, 2, 3) how far a pixel of the drawing moves with x, y and the angle."""
        v, u = np.mgrid[: window.side, : window.side].reshape(2, -1) + 0.5
        pivot = self._pivot + self._along @ (pose[:2] - self._place)
        offset = np.stack([window.left + u * window.step, window.top + v * window.step], axis=-1) - pivot
        quarter = np.array([[0.0, -1.0], [1.0, 0.0]])
        motions = np.empty((len(u), 2, 3), np.float32)
        motions[..., :2] = self._along
        motions[..., 2] = offset @ (self._along @ quarter @ np.linalg.inv(self._along)).T
        return motions / window.step


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


def explain(drawing: Drawing, target: np.ndarray, motions: np.ndarray, step: int) -> tuple[float, np.ndarray]:
    """What light, colour and a small motion leave of the difference between a drawing and the target.

    Args:
        drawing: of side n.
        target: (n, n, 4) Lab and salience.
        motions: (n * n, 2, 3) how far pixels move with x, y and the angle.
        step: pixels of the camera to one of the drawing.

    Returns:
        (robust mean over the window in [0, 1], (3,) motion in metres and radians).
    """
    if not drawing.covered.any():
        return 1.0, np.zeros(3)
    inside = np.flatnonzero(drawing.covered)
    cover = drawing.covered.astype(np.float32)
    blurred = cv2.GaussianBlur(cover, (0, 0), SOFT / step)
    lab = to_lab(drawing.picture) * WEIGHTS
    lab = cv2.GaussianBlur(lab * cover[..., None], (0, 0), SOFT / step) / np.maximum(blurred, 1e-3)[..., None]
    known = lab.reshape(-1, 3)[inside]
    difference = target.reshape(-1, 4)[inside, :3] * WEIGHTS - known
    # Slopes of the colours end at the outline, as nothing is known beyond it.
    inner = (blurred.ravel()[inside, None, None] > INNER).astype(np.float32)
    design = np.zeros((len(inside), 3, len(PRIOR)), np.float32)
    design[:, 0, :5] = _light(known, drawing.normals.reshape(-1, 3)[inside])
    design[:, 1, 5] = design[:, 2, 6] = 1
    design[..., 7:] = np.matmul(_slopes(lab).reshape(-1, 3, 2)[inside] * -inner, motions[inside])
    beside = COVER * (target[..., 3] - blurred).ravel()
    slopes = _slopes(blurred).reshape(-1, 1, 2)
    edge = np.flatnonzero(slopes.any(axis=(1, 2)))
    outline = -COVER * np.matmul(slopes[edge], motions[edge])[:, 0]
    answer, left, beside[edge] = _regress(design, difference, outline, beside[edge])
    squares = beside**2
    squares[inside] += (left**2).sum(axis=1)
    strain = float(answer**2 @ PRIOR) / len(squares) / SCALE**2
    return float((squares / (squares + SCALE**2)).mean()) + strain, answer[7:]


def _slopes(picture: np.ndarray) -> np.ndarray:
    """(..., 2) of a picture along u and v."""
    return np.stack([cv2.Sobel(picture, cv2.CV_32F, *order, scale=0.125) for order in ((1, 0), (0, 1))], axis=-1)


def _light(known: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """(n, 5) how light may change the lightness of pixels: by an offset, a factor, and by where they face."""
    return np.column_stack([np.ones(len(known)), known[:, 0] - known[:, 0].mean(), normals - normals.mean(axis=0)])


def _regress(
    design: np.ndarray, difference: np.ndarray, outline: np.ndarray, beside: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What explains the difference of colours (n, 3) and of coverage (m,), and what it leaves of both.

    Pixels that stay far off, like those hidden by another object, lose their weight.
    """
    flat, wanted = design.reshape(-1, len(PRIOR)), difference.ravel()
    left, rim = np.zeros_like(difference), np.zeros_like(beside)
    answer = np.zeros(len(PRIOR))
    for _ in range(PASSES):
        weighted = flat * np.repeat(1 / (1 + (left**2).sum(axis=1) / SCALE**2), 3)[:, None]
        matrix, right = weighted.T @ flat + np.diag(PRIOR), weighted.T @ wanted
        pull = outline / (1 + rim**2 / SCALE**2)[:, None]
        matrix[7:, 7:] += pull.T @ outline
        right[7:] += pull.T @ beside
        answer = np.linalg.solve(matrix, right)
        left = (wanted - flat @ answer).reshape(-1, 3)
        rim = beside - outline @ answer[7:]
    return answer, left, rim


def settle_drawn(
    view: View, record: ObjectRecord, camera: Camera, pose: np.ndarray, drawer: Drawer, order: int
) -> np.ndarray:
    """The pose near a found one (4,), at any heading, at which the object's drawing is most like the target.

    Args:
        view: the target in the colours of the source.
        record: the object.
        camera: took the source.
        drawer: has a model of it.
        order: n-fold symmetry seen from above; of headings that look the same by it the smallest turn is taken,
            unless the drawings say otherwise. What is round (0) is only moved.
    """
    comparison = Comparison(view, record, camera, drawer, pose[:2].copy())
    step = comparison.small
    turns = [0.0] if order == 0 else pose[2] + np.arange(HEADINGS) * 2 * np.pi / HEADINGS
    around = [comparison.at(np.array([*pose[:2], turn]), step) for turn in turns]
    left = np.array([one.left for one in around])
    peaks = np.flatnonzero((left <= np.roll(left, 1)) & (left <= np.roll(left, -1)))
    peaks = peaks[np.argsort(left[peaks], kind="stable")][:SMALL_PEAKS]
    near = sorted((comparison.at(comparison.moved(around[k]), step) for k in peaks), key=lambda one: one.left)
    best = min((comparison.at(comparison.moved(one), 1) for one in near[:PEAKS]), key=lambda one: one.left)
    for _ in range(ROUNDS):
        best = min(best, comparison.at(comparison.moved(best), 1), key=lambda one: one.left)
    same = [*best.pose[:2], smallest_turn(best.pose[2], order)]
    if order == 0:
        return np.array([*same, pose[3]])
    if order > 1 and best.left > CLEARLY * comparison.at(np.array(same), 1).left:
        return np.array([*same, pose[3]])
    return np.array([*best.pose[:2], wrap_angle(best.pose[2]), pose[3]])
