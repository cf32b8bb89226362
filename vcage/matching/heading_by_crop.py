"""Which way an object that was found faces: headings all around it compared by what breaks its symmetry.

Most of an object looks the same at some wrong heading, and what differs there by light weighs more than the word on a
lid. So the picture and the crop are compared once more at full resolution without what light makes of them: lightness
without its cubic trend over the object, the other colours without their slope.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from vcage.vision.object_templates import Crop, View, dense_points
from vcage.vision.pose_score import LIGHTNESS, Fit, fit, pixels_of, placed, refine, turned_towards

HEADINGS = 48
"""Headings around the circle that are compared first."""

PEAKS = 4
"""Of these the best that are better than their neighbours are refined, beside the found one and its flips."""

FLIPS = np.array([0.0, np.pi, np.pi / 2, -np.pi / 2])

SOFT = 1.2
"""Standard deviation of the blur of the source, pixels: image models draw softer than a renderer."""

STEPS, ROUNDS = np.array([1.0, 1.0, 0.06, 0.01]), 6
"""First steps along x, y (pixels of the compared size), angle (radians) and log scale, and how often they are made."""

FIT_WEIGHTS = np.array([0.7, 0.05, 0.1, 0.25])
"""Of colour, structure, fill and border beside the pattern's correlation: of a logistic choice among headings."""

FAINT = 2.0
"""Mean squared difference of a pattern that says nothing, Lab units squared."""


@dataclass(frozen=True)
class Pattern:
    """What is seen on an object beside its light.

    Args:
        points: (n, 3) relative to its origin, world axes of the source, metres.
        facing: (n, 2) horizontal directions out of it there; 0 on top.
        trends: orthonormal (n, k) of the lightness and (n, l) of the other colours that light explains.
        values: (n, 3) what they leave of the crop's colours.
    """

    points: np.ndarray
    facing: np.ndarray
    trends: tuple[np.ndarray, np.ndarray]
    values: np.ndarray


def softened(source: View) -> View:
    """The source as soft as image models draw."""
    return View(cv2.GaussianBlur(source.lab, (0, 0), SOFT), source.salience)


def pattern_of(source: View, crop: Crop) -> Pattern:
    """The pattern of a crop in the :func:`softened` source."""
    pixels, points, facing = dense_points(crop)
    trends = _trends(points, facing)
    return Pattern(points, facing, trends, _without(source.sample(pixels[None], 1.0)[0, :, :3], trends))


def _trends(points: np.ndarray, facing: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What light may do: a polynomial over the object, and sides that are lighter or darker than the top.

    The polynomials of a degree stay the same as a whole when the object turns and moves: one basis does for all poses.
    """
    flat = points[:, :2] - points[:, :2].mean(axis=0)
    x, y = (flat / (np.abs(flat).max() + 1e-9)).T
    side = (np.abs(facing).sum(axis=1) > 0).astype(float)
    slope = [np.ones_like(x), x, y, *([side] if 0.02 < side.mean() < 0.98 else [])]
    cubic = [*slope, x * x, x * y, y * y, x**3, x * x * y, x * y * y, y**3]
    return tuple(np.linalg.qr(np.stack(terms, axis=1))[0].astype(np.float32) for terms in (cubic, slope))


def _without(lab: np.ndarray, trends: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """(..., n, 3) weighted Lab of the points less its trends."""
    light, colour = lab[..., :1] * np.float32(LIGHTNESS), lab[..., 1:]
    rest = [part - basis @ (basis.T @ part) for part, basis in zip((light, colour), trends, strict=True)]
    return np.concatenate(rest, axis=-1)


def correlation(view: View, crop: Crop, pattern: Pattern, poses: np.ndarray) -> np.ndarray:
    """(b,) in [-1, 1]: of a pattern with the target at poses (b, 4)."""
    at = placed(crop, poses, pattern.points)
    shown = (turned_towards(crop, poses, at, pattern.facing) >= 0).astype(np.float32)
    shown /= np.maximum(shown.sum(axis=1, keepdims=True), 1)
    found = _without(view.sample(pixels_of(crop.camera, at), 1.0)[..., :3], pattern.trends)
    product = np.einsum("bn,bn->b", shown, np.einsum("bnc,nc->bn", found, pattern.values))
    known = shown @ (pattern.values**2).sum(axis=1)
    seen = np.einsum("bn,bn->b", shown, (found**2).sum(axis=-1))
    return product / np.sqrt((known + FAINT) * (seen + FAINT))


def settle(view: View, source: View, crop: Crop, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The pose near a found one (4,), at any heading, at which the object is most surely seen.

    Args:
        view: the target in the colours of the source.
        source: the :func:`softened` source.

    Returns:
        ((4,) pose, (4,) terms of its fit).
    """
    pattern = pattern_of(source, crop)
    around = np.repeat(pose[None], HEADINGS, axis=0)
    around[:, 2] += np.arange(HEADINGS) * 2 * np.pi / HEADINGS
    first = _goodness(view, crop, pattern, fit(view, crop, around))
    peaks = np.flatnonzero((first >= np.roll(first, 1)) & (first >= np.roll(first, -1)))
    flips = np.repeat(pose[None], len(FLIPS), axis=0)
    flips[:, 2] += FLIPS
    starts = np.concatenate([flips, around[peaks[np.argsort(-first[peaks], kind="stable")][:PEAKS]]])
    size = crop.step * crop.pixel
    fine = refine(view, crop, starts, STEPS * [size, size, 1, 1], ROUNDS)
    best = int(np.argmax(_goodness(view, crop, pattern, fine)))
    return fine.poses[best], fine.terms[best]


def _goodness(view: View, crop: Crop, pattern: Pattern, found: Fit) -> np.ndarray:
    return correlation(view, crop, pattern, found.poses) + found.terms @ FIT_WEIGHTS
