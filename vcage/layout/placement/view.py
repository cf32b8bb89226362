"""Rectangles of the table in which a camera sees an object whole, for the placement.

A box is seen whole when its corners are, as a pinhole camera's view is convex. Of an upright box of one height the
footprint must then lie in a convex polygon of the table's plane: the view at the table's height cut with the view at
the box's top. Rectangles inside that polygon are exact; below a camera that looks straight down and is not rolled
against the table there is one, and it is the polygon itself.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from vcage.base.errors import UsageError
from vcage.base.geometry import Camera
from vcage.layout.placement.free_region import TOLERANCE
from vcage.layout.validation import as_workspace

STRIPS = 24
"""Lines across the plane between which rectangles are spanned when the polygon is none itself."""


def view_rectangles(
    camera: Camera, support: float, height: float, bounds: ArrayLike, border: float = 0.0
) -> np.ndarray:
    """(m, 2, 2) maximal rectangles; a box of ``height`` is seen whole when its footprint lies in one of them.

    None of them reaches beyond the view; a tilted camera's polygon is filled up to the width of a strip.

    Args:
        camera: that must see it.
        support: z of the plane that the box stands on, metres.
        height: of the box, metres.
        bounds: (2, 2) lower and upper corner of the part of the plane that matters, metres.
        border: pixels that stay free along the picture's edges.

    Raises:
        UsageError: a height or border that is negative or not finite, or bounds without an inside.
    """
    if not (np.isfinite([support, height, border]).all() and height >= 0 and border >= 0):
        raise UsageError(
            f"no view of a box of {height} m at {support} m, {border} pixels from the edge",
            hint="heights are metres and borders pixels, 0 or more",
        )
    lower, upper = as_workspace(bounds)
    normals, limits = _sides(camera, support, height, border)
    lines = np.linspace(lower[1], upper[1], STRIPS + 1)
    lines = np.unique(np.concatenate([lines, _turns(normals, limits, lower, upper)]))
    left, right = _spans(normals, limits, lines, lower[0], upper[0])
    a, b = np.triu_indices(len(lines), 1)
    # The visible area is convex: a rectangle belongs to it when its upper and its lower edge do.
    lower = np.stack([np.maximum(left[a], left[b]), lines[a]], axis=1)
    upper = np.stack([np.minimum(right[a], right[b]), lines[b]], axis=1)
    return _maximal(np.stack([lower, upper], axis=1)[upper[:, 0] > lower[:, 0]])


def _sides(camera: Camera, support: float, height: float, border: float) -> tuple[np.ndarray, np.ndarray]:
    """Half planes ``normal · point >= limit``, (n, 2) and (n,), of the view at both heights."""
    u = max(camera.width / 2 - border, 0.0) / camera.focal
    v = max(camera.height / 2 - border, 0.0) / camera.focal
    # Camera frame: x forward, y left, z up; the sides of the view point inwards, and so does the front.
    inwards = np.array([[u, 1, 0], [u, -1, 0], [v, 0, 1], [v, 0, -1]]) @ camera.pose.rotation().T  # (4, 3)
    at_zero = inwards @ camera.pose.p
    limits = np.concatenate([at_zero - inwards[:, 2] * z for z in (support, support + height)])
    return np.tile(inwards[:, :2], (2, 1)), limits


def _spans(
    normals: np.ndarray, limits: np.ndarray, y: np.ndarray, lower: float, upper: float
) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the view along each line of constant ``y`` (k,); empty where the first is the larger."""
    left, right = np.full(len(y), lower), np.full(len(y), upper)
    for (nx, ny), limit in zip(normals, limits, strict=True):
        needed = limit - ny * y
        if nx > TOLERANCE:
            left = np.maximum(left, needed / nx)
        elif nx < -TOLERANCE:
            right = np.minimum(right, needed / nx)
        else:
            right = np.where(needed > TOLERANCE, -np.inf, right)
    return left, right


def _turns(normals: np.ndarray, limits: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """y of the polygon's corners and of the ends of sides along x, where they lie between the bounds."""
    sides = np.concatenate([normals, [[1, 0], [-1, 0]]])
    values = np.concatenate([limits, [lower[0], -upper[0]]])
    found = []
    for a, b in combinations(range(len(sides)), 2):
        pair = sides[[a, b]]
        if abs(np.linalg.det(pair)) > TOLERANCE:
            found.append(np.linalg.solve(pair, values[[a, b]])[1])
    found = np.array(found)
    return found[(found > lower[1]) & (found < upper[1])]


def _maximal(rectangles: np.ndarray) -> np.ndarray:
    """(k, 2, 2) rectangles of a list that lie in no other one."""
    lower, upper = rectangles[:, 0], rectangles[:, 1]
    inside = np.all(lower[:, None] >= lower - TOLERANCE, axis=2) & np.all(upper[:, None] <= upper + TOLERANCE, axis=2)
    equal_and_later = inside.T & np.tri(len(rectangles), k=-1, dtype=bool)
    return rectangles[~np.any(inside & (~inside.T | equal_and_later), axis=1)]
