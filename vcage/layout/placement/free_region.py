"""The free region of an object's centre: where it may stand without touching anything, exactly.

An axis-aligned footprint of half size h keeps clear of an obstacle by the gap g exactly when its centre lies
outside the obstacle grown by h + g (a Minkowski sum of rectangles), and lies in the workspace exactly when its
centre lies in the workspace shrunk by h. The free region is therefore a union of rectangles; on the grid of all
their edges every cell is free or blocked as a whole, so it is computed without sampling or resolution.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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

    @classmethod
    def nowhere(cls) -> FreeRegion:
        """The empty region."""
        return cls(np.zeros(2), np.zeros(2), np.zeros((1, 1), dtype=bool))

    @property
    def is_empty(self) -> bool:
        """True if the object fits nowhere."""
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
        return self.samples(rng, 1)[0]

    def samples(self, rng: np.random.Generator, count: int) -> np.ndarray:
        """(count, 2) points drawn uniformly by area; raises as :meth:`sample`."""
        if self.is_empty:
            raise ValueError("an empty region has no points")
        heaped = np.cumsum(self._areas())
        cells = np.searchsorted(heaped, rng.random(count) * heaped[-1], side="right").clip(max=heaped.size - 1)
        i, j = np.divmod(cells, self.free.shape[1])
        lower = np.stack([self.x[i], self.y[j]], axis=-1)
        upper = np.stack([self.x[i + 1], self.y[j + 1]], axis=-1)
        return lower + rng.random((count, 2)) * (upper - lower)

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
        padded = np.zeros((self.free.shape[0] + 2, self.free.shape[1] + 2), dtype=bool)
        padded[1:-1, 1:-1] = free = self.free
        vertex = np.zeros((len(self.x), len(self.y)), dtype=bool)
        for x_side, columns in ((padded[:-2, 1:-1], slice(0, -1)), (padded[2:, 1:-1], slice(1, None))):
            ends = free & ~x_side
            for y_side, rows in ((padded[1:-1, :-2], slice(0, -1)), (padded[1:-1, 2:], slice(1, None))):
                vertex[columns, rows] |= ends & ~y_side
        i, j = np.nonzero(vertex)
        return np.stack([self.x[i], self.y[j]], axis=-1)


def free_region(
    bounds: ArrayLike,
    half_size: ArrayLike,
    obstacles: ArrayLike = (),
    gap: ArrayLike = 0.0,
    unions: Sequence[ArrayLike] = (),
) -> FreeRegion:
    """Return the free region of the centre of a footprint.

    Args:
        bounds: (2, 2) lower and upper corner that the footprint must stay within, metres.
        half_size: (2,) half size of the footprint's axis-aligned rectangle.
        obstacles: (n, 2, 2) rectangles to keep clear of.
        gap: scalar or (n,) distance to keep along at least one axis.
        unions: (m, 2, 2) each; the centre must lie in one rectangle of each (where it is reached, where it is seen).
    """
    bounds, half_size = np.asarray(bounds, dtype=np.float64), np.asarray(half_size, dtype=np.float64)
    obstacles = np.asarray(obstacles, dtype=np.float64).reshape(-1, 2, 2)
    domain = np.stack([bounds[0] + half_size - TOLERANCE, bounds[1] - half_size + TOLERANCE])
    if np.any(domain[0] >= domain[1]):
        return FreeRegion.nowhere()
    grow = half_size - TOLERANCE + np.asarray(gap, dtype=np.float64)[..., None]
    blocked = np.empty_like(obstacles)
    blocked[:, 0], blocked[:, 1] = obstacles[:, 0] - grow, obstacles[:, 1] + grow
    widened = [np.asarray(union, dtype=np.float64).reshape(-1, 2, 2) + _WIDENED for union in unions]
    x, y = _edges(domain, np.concatenate([blocked, *widened]))
    free = np.ones((len(x) - 1, len(y) - 1), dtype=bool)
    for union in widened:
        covered = np.zeros_like(free)
        for cells in _covered(union, x, y):
            covered[cells] = True
        free &= covered
    for cells in _covered(blocked, x, y):
        free[cells] = False
    return FreeRegion(x, y, free)


_WIDENED = np.array([[-TOLERANCE], [TOLERANCE]])


def _edges(domain: np.ndarray, rectangles: np.ndarray) -> Iterator[np.ndarray]:
    """Ascending x and y of all edges inside the domain, and of the domain itself."""
    for axis in (0, 1):
        edges = rectangles[..., axis].ravel()
        lower, upper = domain[:, axis]
        edges = np.sort(np.concatenate([domain[:, axis], edges[(edges > lower) & (edges < upper)]]))
        yield edges[np.concatenate([_FIRST, edges[1:] > edges[:-1]])]


_FIRST = np.array([True])


def _covered(rectangles: np.ndarray, x: np.ndarray, y: np.ndarray) -> Iterator[tuple[slice, slice]]:
    """The block of grid cells under each rectangle; all edges inside the domain are grid edges."""
    i, j = np.searchsorted(x, rectangles[..., 0]).tolist(), np.searchsorted(y, rectangles[..., 1]).tolist()
    for (i0, i1), (j0, j1) in zip(i, j, strict=True):
        yield slice(i0, i1), slice(j0, j1)


def nearest_in_rectangles(point: ArrayLike, rectangles: ArrayLike) -> np.ndarray:
    """(2,) the point of a union of rectangles (k, 2, 2) closest to ``point``; the first one of equals."""
    point, rectangles = np.asarray(point, dtype=np.float64), np.asarray(rectangles, dtype=np.float64)
    inside = np.clip(point, rectangles[:, 0], rectangles[:, 1])  # (k, 2)
    return inside[np.argmin(((inside - point) ** 2).sum(axis=1))]
