"""Convex polyhedra as vertices and half-spaces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import ConvexHull, QhullError

from vcage.base.errors import DamagedFile
from vcage.base.placeholders import require_fetched


@dataclass(frozen=True)
class Convex:
    """A convex polyhedron: all x with ``normals @ x <= offsets``.

    Args:
        vertices: (n, 3).
        edges: (e, 2) vertex indices; may hold diagonals of flat faces.
        normals: (m, 3) outward unit normals.
        offsets: (m,).
        volume: m³.
    """

    vertices: np.ndarray
    edges: np.ndarray
    normals: np.ndarray
    offsets: np.ndarray
    volume: float

    @classmethod
    def of(cls, points: ArrayLike) -> Convex:
        """The convex hull of points (n, 3)."""
        hull = ConvexHull(np.asarray(points, dtype=np.float64))
        triangles = hull.simplices
        edges = np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
        return cls(hull.points, edges, hull.equations[:, :3], -hull.equations[:, 3], float(hull.volume))

    def outside(self, points: ArrayLike) -> np.ndarray:
        """(...,) how far points lie beyond the farthest face: negative inside, at most the distance outside."""
        return (np.asarray(points, dtype=np.float64) @ self.normals.T - self.offsets).max(axis=-1)

    def interval(self, origin: ArrayLike, direction: ArrayLike) -> tuple[float, float] | None:
        """The stretch (t0, t1) of the line ``origin + t · direction`` inside, or None."""
        ((enter, leave),) = self.intervals(np.asarray(origin, dtype=np.float64)[None], direction)
        return (float(enter), float(leave)) if enter < leave else None

    def intervals(self, origins: ArrayLike, direction: ArrayLike) -> np.ndarray:
        """(k, 2) the stretches (t0, t1) inside of lines through ``origins`` (k, 3); t0 ≥ t1 where a line misses it."""
        speed = self.normals @ np.asarray(direction, dtype=np.float64)
        gaps = self.offsets - np.asarray(origins, dtype=np.float64) @ self.normals.T
        into, out_of = speed < -1e-12, speed > 1e-12
        enter = (gaps[:, into] / speed[into]).max(axis=1, initial=-np.inf)
        leave = (gaps[:, out_of] / speed[out_of]).min(axis=1, initial=np.inf)
        misses = np.any(gaps[:, ~(into | out_of)] < 0, axis=1)
        return np.stack([enter, np.where(misses, -np.inf, leave)], axis=1)

    def shadow(self, low: float, high: float = np.inf) -> np.ndarray:
        """(k, 2) points whose convex hull is the vertical projection of the shape between two heights; k may be 0."""
        z = self.vertices[:, 2]
        points = [self.vertices[(z >= low) & (z <= high), :2]]
        a, b = self.vertices[self.edges[:, 0]], self.vertices[self.edges[:, 1]]
        for height in (low, high):
            crosses = (a[:, 2] < height) != (b[:, 2] < height)
            p, q = a[crosses], b[crosses]
            share = (height - p[:, 2]) / (q[:, 2] - p[:, 2]) if np.isfinite(height) else np.zeros(len(p))
            points.append((p + share[:, None] * (q - p))[:, :2])
        return np.concatenate(points)


def load_convex(path: str | Path) -> Convex:
    """Read a convex piece from an OBJ file.

    Raises:
        DamagedFile: it is missing, names another file, or holds no solid.
    """
    require_fetched(Path(path))
    try:
        lines = Path(path).read_text(encoding="ascii").splitlines()
        if any(line.lstrip().startswith("mtllib") for line in lines):
            raise ValueError("it names a file of materials")
        vertices = [[float(x) for x in line.split()[1:4]] for line in lines if line.startswith("v ")]
        if len(vertices) < 4:
            raise ValueError(f"{len(vertices)} vertices")
        return Convex.of(vertices)
    except (OSError, ValueError, QhullError) as error:
        raise DamagedFile(
            f"{path} is not a convex mesh: {error}", hint="delete the folder it lies in; it is built again on demand"
        ) from error


def centre_of_mass(pieces: Sequence[Convex]) -> NDArray[np.float64]:
    """(3,) centre of mass of some pieces of one density, metres."""
    centres, volumes = zip(*(_centre_of(piece) for piece in pieces), strict=True)
    return np.average(centres, axis=0, weights=volumes)


def _centre_of(piece: Convex) -> tuple[NDArray[np.float64], float]:
    """(3,) centre of a convex piece, and its volume: those of the pyramids from a point in it to its faces."""
    inner = piece.vertices.mean(axis=0)
    corners = piece.vertices[ConvexHull(piece.vertices).simplices] - inner
    volumes = np.abs(np.linalg.det(corners)) / 6
    return inner + (corners.sum(axis=1) / 4 * volumes[:, None]).sum(axis=0) / volumes.sum(), float(volumes.sum())
