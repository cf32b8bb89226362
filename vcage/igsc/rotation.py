"""How far an object is turned between two pictures: normalised cross-correlation over an angular grid
(paper, section III-A3).

What is correlated is the colour inside the object's mask, less its mean, and the mask itself: the silhouette finds
the axis of a plain object, the colours tell its two ends apart.
"""

from __future__ import annotations

import cv2
import numpy as np

PATCH = 72
"""Side of the square patches that are compared, pixels."""
COARSE_DEGREES = 6
FINE_DEGREES = 1
SHAPE_WEIGHT = 0.3
"""Weight of the mask beside colours in [0, 1]."""
TIE = 0.01
"""Peaks of the correlation that are this close are a symmetry of the object; the smallest turn is taken."""
ROUND = 0.03
"""An object whose correlation varies less than this over all angles looks round: it is not turned."""


def estimate_rotation(
    source: np.ndarray, source_mask: np.ndarray, target: np.ndarray, target_mask: np.ndarray
) -> tuple[float, float]:
    """The turn that takes the object of the source picture to that of the target picture.

    Args:
        source, target: (H, W, 3) uint8 pictures of the same scale.
        source_mask, target_mask: (H, W) bool, not empty.

    Returns:
        (angle, ncc): counter-clockwise as seen in the picture, radians in [-π, π); the correlation in [-1, 1].
    """
    radius = max(_radius(source_mask), _radius(target_mask)) + 2
    reference = _patch(source, source_mask, radius)
    turned = _patch(target, target_mask, radius)
    coarse = np.arange(-180, 180, COARSE_DEGREES)
    scores = np.array([_correlation(reference, _rotate(turned, -angle)) for angle in coarse])
    start = int(coarse[_peak(coarse, scores)]) if np.ptp(scores) > ROUND else 0
    if np.ptp(scores) <= ROUND:
        return 0.0, _correlation(reference, turned)
    fine = np.arange(start - COARSE_DEGREES + FINE_DEGREES, start + COARSE_DEGREES, FINE_DEGREES)
    scores = np.array([_correlation(reference, _rotate(turned, -angle)) for angle in fine])
    best = int(np.argmax(scores))
    return float(np.deg2rad((fine[best] + 180) % 360 - 180)), float(scores[best])


def mask_centroid(mask: np.ndarray) -> np.ndarray:
    """(2,) u, v of the middle of a mask, pixels."""
    v, u = np.nonzero(mask)
    return np.array([u.mean() + 0.5, v.mean() + 0.5])


def _peak(angles: np.ndarray, scores: np.ndarray) -> int:
    """Index of the highest local maximum; of nearly equal ones that with the smallest angle."""
    is_peak = (scores >= np.roll(scores, 1)) & (scores >= np.roll(scores, -1)) & (scores >= scores.max() - TIE)
    peaks = np.nonzero(is_peak)[0]
    return int(peaks[np.argmin(np.abs(angles[peaks]))])


def _radius(mask: np.ndarray) -> float:
    v, u = np.nonzero(mask)
    centre = mask_centroid(mask)
    return float(np.hypot(u + 0.5 - centre[0], v + 0.5 - centre[1]).max())


def _patch(picture: np.ndarray, mask: np.ndarray, radius: float) -> np.ndarray:
    """(PATCH, PATCH, 4) float32: colours in the mask less their mean, and the weighted mask."""
    u, v = mask_centroid(mask)
    side = int(np.ceil(2 * radius))
    # The patch's centre, (side - 1) / 2 as an index, takes the pixel at the centroid.
    shift = np.array([[1, 0, u - side / 2], [0, 1, v - side / 2]])
    inside = mask.astype(np.float32)
    colours = (picture.astype(np.float32) / 255 - picture[mask].mean(axis=0) / 255) * inside[..., None]
    features = np.dstack([colours, SHAPE_WEIGHT * inside]).astype(np.float32)
    crop = cv2.warpAffine(features, shift, (side, side), flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP)
    return cv2.resize(crop, (PATCH, PATCH), interpolation=cv2.INTER_AREA if side > PATCH else cv2.INTER_LINEAR)


def _rotate(patch: np.ndarray, degrees: float) -> np.ndarray:
    """The patch turned counter-clockwise about its centre."""
    centre = (PATCH - 1) / 2
    return cv2.warpAffine(patch, cv2.getRotationMatrix2D((centre, centre), degrees, 1.0), (PATCH, PATCH))


def _correlation(a: np.ndarray, b: np.ndarray) -> float:
    a, b = a - a.mean(axis=(0, 1)), b - b.mean(axis=(0, 1))
    norm = np.sqrt((a * a).sum() * (b * b).sum())
    return float((a * b).sum() / norm) if norm > 0 else 0.0
