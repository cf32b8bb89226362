"""Photometric alignment of a drawing of an object with the target: the light, colour and small motion that explain the
difference, and the residual.

Gauss-Newton on the motion of the drawing (B. Lucas and T. Kanade, IJCAI 1981) together with an affine model of light,
all with Gaussian priors: they are linear in the difference, so a step is one ridge regression, made robust by iterative
reweighting (Cauchy weights). The score of a pose is the Geman-McClure loss of the residual.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from vcage.sim.drawer import Drawing
from vcage.vision.colour import to_lab
from vcage.vision.pose_score import LIGHTNESS

WEIGHTS = np.array([LIGHTNESS, 1, 1], np.float32)
"""Of the channels of Lab."""

LIGHT_PRIOR = np.array([30.0, 0.3, 20.0, 20.0, 20.0, 8.0, 8.0])
"""Standard deviations of the light's effects: lightness (offset, factor, along the normal's three components), and the
two other channels (offset)."""

MOTION_PRIOR = np.array([0.005, 0.005, 0.12])
"""Standard deviations of the motion of one step: x, y (metres), angle (radians)."""

PRIOR = 360.0 / np.concatenate([LIGHT_PRIOR, MOTION_PRIOR]) ** 2
"""Costs in the regression, in squared colour distances: a standard deviation costs little more than a far pixel."""


@dataclass(frozen=True)
class AlignmentSettings:
    """Scales of the alignment; colour distances in weighted Lab units.

    Args:
        blur_px: standard deviation of the blur of drawings, pixels of the camera: image models draw softer than a
            renderer.
        cover_distance: colour distance between table and object.
        loss_scale: colour distance at which a pixel's Geman-McClure loss is 1/2.
        rounds: of reweighted least squares.
        inner_coverage: least coverage of a pixel whose colours have slopes; others are too close to the outline.
        outline_px: reach of the blurred outline around the object, pixels of a drawing.
    """

    blur_px: float = 1.0
    cover_distance: float = 20.0
    loss_scale: float = 15.0
    rounds: int = 2
    inner_coverage: float = 0.9
    outline_px: int = 6


SETTINGS = AlignmentSettings()


def align(
    drawing: Drawing, target: np.ndarray, motions: np.ndarray, step: int, focal: float
) -> tuple[float, np.ndarray]:
    """One Gauss-Newton step: the motion of a drawing towards the target, and the residual after motion and light.

    Args:
        drawing: of side n.
        target: (n, n, 4) Lab and salience.
        motions: (n, n, 2, 3) motion of each pixel with x, y and the angle.
        step: pixels of the camera to one of the drawing.
        focal: of the camera, pixels.

    Returns:
        (mean Geman-McClure loss over the window in [0, 1], (3,) motion in metres and radians).
    """
    if not drawing.covered.any():
        return 1.0, np.zeros(3)
    s = SETTINGS
    empty = _loss((s.cover_distance * target[..., 3]) ** 2)
    # Beyond the blur of its outline, the object changes nothing.
    u, v, width, height = cv2.boundingRect(drawing.covered.astype(np.uint8))
    reach = s.outline_px
    near = slice(max(0, v - reach), v + height + reach), slice(max(0, u - reach), u + width + reach)
    beyond = float(empty.sum() - empty[near].sum())
    target, motions = target[near], motions[near].reshape(-1, 2, 3)
    cover = drawing.covered[near].astype(np.float32)
    blurred = cv2.GaussianBlur(cover, (0, 0), s.blur_px / step)
    lab = to_lab(drawing.picture[near]) * WEIGHTS
    lab = cv2.GaussianBlur(lab * cover[..., None], (0, 0), s.blur_px / step) / np.maximum(blurred, 1e-3)[..., None]
    inside = np.flatnonzero(cover)
    known = lab.reshape(-1, 3)[inside]
    difference = target.reshape(-1, 4)[inside, :3] * WEIGHTS - known
    # Slopes of the colours end at the outline: beyond it no colour is known.
    inner = (blurred.ravel()[inside, None, None] > s.inner_coverage).astype(np.float32)
    design = np.zeros((len(inside), 3, len(PRIOR)), np.float32)
    design[:, 0, :5] = _light(known, _normals(drawing.depth[near], focal / step).reshape(-1, 3)[inside])
    design[:, 1, 5] = design[:, 2, 6] = 1
    design[..., 7:] = np.matmul(_slopes(lab).reshape(-1, 3, 2)[inside] * -inner, motions[inside])
    beside = s.cover_distance * (target[..., 3] - blurred).ravel()
    slopes = _slopes(blurred).reshape(-1, 1, 2)
    edge = np.flatnonzero(slopes.any(axis=(1, 2)))
    outline = -s.cover_distance * np.matmul(slopes[edge], motions[edge])[:, 0]
    answer, left, beside[edge] = _regress(design, difference, outline, beside[edge])
    squares = beside**2
    squares[inside] += (left**2).sum(axis=1)
    strain = float(answer**2 @ PRIOR) / s.loss_scale**2
    return (float(_loss(squares).sum()) + beyond + strain) / empty.size, answer[7:]


def _loss(squares: np.ndarray) -> np.ndarray:
    """The Geman-McClure loss of squared colour distances, in [0, 1]."""
    return squares / (squares + SETTINGS.loss_scale**2)


def _slopes(picture: np.ndarray) -> np.ndarray:
    """(..., 2) slopes of a picture along u and v."""
    return np.stack([cv2.Sobel(picture, cv2.CV_32F, *order, scale=0.125) for order in ((1, 0), (0, 1))], axis=-1)


def _normals(depth: np.ndarray, focal: float) -> np.ndarray:
    """(h, w, 3) unit normals towards the camera, in its frame (OpenCV), of a depth picture; exact on its axis."""
    along_v, along_u = (_rise(depth, axis) * focal / depth for axis in (0, 1))
    normals = np.stack([along_u, along_v, np.full_like(depth, -1.0)], axis=-1)
    return normals / np.sqrt(along_u**2 + along_v**2 + 1)[..., None]


def _rise(depth: np.ndarray, axis: int) -> np.ndarray:
    """(h, w) difference to the nearer in depth of both neighbours: the other may lie across an outline."""
    steps = np.diff(depth, axis=axis)
    edge = np.full_like(depth.take([0], axis), np.inf)
    ahead, behind = np.concatenate([steps, edge], axis=axis), np.concatenate([edge, steps], axis=axis)
    return np.where(np.abs(ahead) < np.abs(behind), ahead, behind)


def _light(known: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """(n, 5) effects of light on the lightness of pixels: an offset, a factor, and by their normals."""
    return np.column_stack([np.ones(len(known)), known[:, 0] - known[:, 0].mean(), normals - normals.mean(axis=0)])


def _regress(
    design: np.ndarray, difference: np.ndarray, outline: np.ndarray, beside: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The parameters that explain the difference of colours (n, 3) and of coverage (m,), and the residuals of both.

    Pixels that stay far off, like those hidden by another object, lose their weight: iteratively reweighted least
    squares with Cauchy weights.
    """
    squared_scale = SETTINGS.loss_scale**2
    flat, wanted = design.reshape(-1, len(PRIOR)), difference.ravel()
    left, rim = np.zeros_like(difference), np.zeros_like(beside)
    answer = np.zeros(len(PRIOR))
    for _ in range(SETTINGS.rounds):
        weighted = flat * np.repeat(1 / (1 + (left**2).sum(axis=1) / squared_scale), 3)[:, None]
        matrix, right = weighted.T @ flat + np.diag(PRIOR), weighted.T @ wanted
        pull = outline / (1 + rim**2 / squared_scale)[:, None]
        matrix[7:, 7:] += pull.T @ outline
        right[7:] += pull.T @ beside
        answer = np.linalg.solve(matrix, right)
        left = (wanted - flat @ answer).reshape(-1, 3)
        rim = beside - outline @ answer[7:]
    return answer, left, rim
