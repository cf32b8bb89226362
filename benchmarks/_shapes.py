"""Test if solids of convex pieces meet: the one exact test of every benchmark, independent of the code under test."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import ConvexHull

TOUCHING = 0.005
"""Deepest penetration of two convex pieces that still counts as touching (SceneEval's rule), metres."""

ROUNDING = 1e-6
"""Overlap of boxes that is rounding, metres."""


def penetration(a: np.ndarray, b: np.ndarray) -> float:
    """Length of the shortest shift that parts two solids, the convex hulls of points (n, 3) and (m, 3); 0 when apart.

    It is the distance from the origin to the nearest face of the Minkowski difference.
    """
    hull = ConvexHull((a[:, None] - b[None]).reshape(-1, 3))
    return max(0.0, float((-hull.equations[:, 3]).min()))


def pieces_collide(first: Sequence[np.ndarray], second: Sequence[np.ndarray]) -> bool:
    """True if a piece of one object penetrates one of the other by more than :data:`TOUCHING`.

    Args:
        first, second: (n, 3) vertices of each convex piece, metres, in one frame.
    """
    # No two pieces penetrate deeper than their boxes do.
    depths = box_depths(*(np.reshape([box_around(v) for v in pieces], (-1, 2, 3)) for pieces in (first, second)))
    near = sorted(np.argwhere(depths > TOUCHING).tolist(), key=lambda pair: -depths[pair[0], pair[1]])
    return any(penetration(first[i], second[j]) > TOUCHING for i, j in near)


def box_around(points: np.ndarray) -> np.ndarray:
    """(2, 3) axis-aligned box around points (n, 3)."""
    return np.stack([points.min(axis=0), points.max(axis=0)])


def box_depths(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(n, m) shortest shift along an axis that parts boxes (n, 2, 3) and (m, 2, 3); negative for a gap.

    It is more than they overlap where one reaches through the other.
    """
    upwards, downwards = a[:, None, 1] - b[None, :, 0], b[None, :, 1] - a[:, None, 0]
    return np.minimum(upwards, downwards).min(axis=2)
