"""The free region of an object's centre: where it may stand without touching anything, exactly.

An axis-aligned footprint of half size h keeps clear of an obstacle by the gap g exactly when its centre lies
outside the obstacle grown by h + g (a Minkowski sum of rectangles), and lies in the workspace exactly when its
centre lies in the workspace shrunk by h. The free region is therefore a union of rectangles; on the grid of all
their edges every cell is free or blocked as a whole, so it is computed without sampling or resolution.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

TOLERANCE = 1e-9
"""Metres by which everything is widened, so that an exact fit is a thin rectangle and not an empty set."""


@dataclass(frozen=True)
class FreeRegion:
    """A union of rectangles: the free cells of a grid.

    Args:
        x: (nx + 1,) ascending cell edges, metres.
        y: (ny + 1,) ascending cell edges, metres.
        free: (nx, ny) bool.
    """

    x: np.ndarray
    y: np.ndarray
    free: np.ndarray

    @property
    def is_empty(self) -> bool:
        """Whether the object fits nowhere."""
        return not self.free.any()

    @property
    def area(self) -> float:
        """Square metres."""
        return float(self._areas().sum())

    def _areas(self) -> np.ndarray:
        return np.outer(np.diff(self.x), np.diff(self.y)) * self.free  # (nx, ny)

    def rectangles(self) -> np.ndarray:
        """(k, 2, 2) disjoint rectangles (lower, upper) whose union is the region."""
        i, j = np.nonzero(self.free)
        lower = np.stack([self.x[i], self.y[j]], axis=-1)
        return np.stack([lower, np.stack([self.x[i + 1], self.y[j + 1]], axis=-1)], axis=1)

    def sample(self, rng: np.random.Generator) -> np.ndarray:
        """(2,) a point drawn uniformly by area.

        Raises:
            ValueError: the region is empty.
        """
        if self.is_empty:
            raise ValueError("an empty region has no points")
        heaped = np.cumsum(self._areas())
        index = min(np.searchsorted(heaped, rng.random() * heaped[-1], side="right"), heaped.size - 1)
        i, j = np.unravel_index(index, self.free.shape)
        return np.array([rng.uniform(self.x[i], self.x[i + 1]), rng.uniform(self.y[j], self.y[j + 1])])

    def nearest(self, point: ArrayLike) -> np.ndarray:
        """(2,) the region's point closest to ``point``.

        Raises:
            ValueError: the region is empty.
        """
        if self.is_empty:
            raise ValueError("an empty region has no points")
        return nearest_in_rectangles(point, self.rectangles())

    def corners(self) -> np.ndarray:
        """(k, 2) convex corners of the region: where the object would touch something along both axes."""
        padded = np.pad(self.free, 1)
        centre = padded[1:-1, 1:-1]
        found = []
        for x, x_side in ((self.x[:-1], padded[:-2, 1:-1]), (self.x[1:], padded[2:, 1:-1])):
            for y, y_side in ((self.y[:-1], padded[1:-1, :-2]), (self.y[1:], padded[1:-1, 2:])):
                i, j = np.nonzero(centre & ~x_side & ~y_side)
                found.append(np.stack([x[i], y[j]], axis=-1))
        return np.unique(np.concatenate(found), axis=0)


def free_region(
    bounds: ArrayLike,
    half_size: ArrayLike,
    obstacles: ArrayLike = (),
    gap: ArrayLike = 0.0,
    allowed: ArrayLike | None = None,
) -> FreeRegion:
    """Where the centre of a footprint may be.

    Args:
        bounds: (2, 2) lower and upper corner that the footprint must stay within, metres.
        half_size: (2,) half size of the footprint's axis-aligned rectangle.
        obstacles: (n, 2, 2) rectangles to keep clear of.
        gap: scalar or (n,) distance to keep along at least one axis.
        allowed: (m, 2, 2) rectangles that the centre must lie in one of (within reach), or None for anywhere.
    """
    bounds, half_size = np.asarray(bounds, dtype=np.float64), np.asarray(half_size, dtype=np.float64)
    obstacles = np.asarray(obstacles, dtype=np.float64).reshape(-1, 2, 2)
    grow = half_size + np.broadcast_to(np.asarray(gap, dtype=np.float64), len(obstacles))[:, None] - TOLERANCE
    blocked = np.stack([obstacles[:, 0] - grow, obstacles[:, 1] + grow], axis=1)
    domain = np.stack([bounds[0] + half_size - TOLERANCE, bounds[1] - half_size + TOLERANCE])
    if np.any(domain[0] >= domain[1]):
        return FreeRegion(np.zeros(2), np.zeros(2), np.zeros((1, 1), dtype=bool))
    reach = np.empty((0, 2, 2)) if allowed is None else np.asarray(allowed, dtype=np.float64).reshape(-1, 2, 2)
    reach = reach + np.array([[-TOLERANCE], [TOLERANCE]])
    x, y = (_edges(domain[:, k], np.concatenate([blocked[..., k], reach[..., k]])) for k in (0, 1))
    free = np.full((len(x) - 1, len(y) - 1), allowed is None)
    for cells in _covered(reach, x, y):
        free[cells] = True
    for cells in _covered(blocked, x, y):
        free[cells] = False
    return FreeRegion(x, y, free)


def _edges(domain: np.ndarray, edges: np.ndarray) -> np.ndarray:
    return np.unique(np.concatenate([domain, np.clip(edges.ravel(), domain[0], domain[1])]))


def _covered(rectangles: np.ndarray, x: np.ndarray, y: np.ndarray) -> Iterator[tuple[slice, slice]]:
    """The block of grid cells under each rectangle; all edges inside the domain are grid edges."""
    i, j = np.searchsorted(x, rectangles[..., 0]), np.searchsorted(y, rectangles[..., 1])  # (n, 2) each
    for (i0, i1), (j0, j1) in zip(i, j, strict=True):
        yield slice(i0, i1), slice(j0, j1)


def nearest_in_rectangles(point: ArrayLike, rectangles: ArrayLike) -> np.ndarray:
    """(2,) the point of a union of rectangles (k, 2, 2) closest to ``point``; the first one of equals."""
    point, rectangles = np.asarray(point, dtype=np.float64), np.asarray(rectangles, dtype=np.float64)
    inside = np.clip(point, rectangles[:, 0], rectangles[:, 1])  # (k, 2)
    return inside[np.argmin(((inside - point) ** 2).sum(axis=1))]
