"""Convex pieces for physics, made analytically: exact, instant, and open where the object is open.

Round things get 16 sides whose middles touch the circle, so that bounding boxes are exact and the free space
inside a ring is never smaller than it looks.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
import trimesh
from numpy.typing import ArrayLike

from vcage.objects.modelling import solids

Piece = trimesh.Trimesh


def hull(*points: ArrayLike) -> Piece:
    """The convex hull of all the points (…, 3)."""
    return trimesh.convex.convex_hull(np.concatenate([np.asarray(p, dtype=np.float64).reshape(-1, 3) for p in points]))


def stack(rings: Sequence[tuple[float, float]], sides: int = 16, centre: tuple[float, float] = (0.0, 0.0)) -> Piece:
    """The hull of horizontal discs given as (radius, z); the circles touch the polygons' sides from inside.

    Args:
        rings: (radius, z) of each disc, metres.
        sides: of the polygon.
        centre: x and y of all discs.
    """
    unit = _ring_corners(sides)
    return hull(*[np.column_stack([unit * r + np.asarray(centre), np.full(sides, z)]) for r, z in rings])


def ring(profile: ArrayLike, sectors: int = 16, centre: tuple[float, float] = (0.0, 0.0)) -> list[Piece]:
    """The wedges of a ring whose convex section (k, 2) is given as (radius, z).

    Args:
        profile: (k, 2) radius and z, metres.
        sectors: number of wedges.
        centre: x and y of the axis.
    """
    unit = _ring_corners(sectors)
    section = np.asarray(profile, dtype=np.float64)
    edges = [np.column_stack([section[:, :1] * u + np.asarray(centre), section[:, 1]]) for u in unit]
    return [hull(edges[i - 1], edges[i]) for i in range(sectors)]


def _ring_corners(sides: int) -> np.ndarray:
    """(sides, 2) corners of a regular polygon around the unit circle, with a side across each axis if 4 divides it."""
    angle = (np.arange(sides) + 0.5) * 2 * np.pi / sides
    return np.stack([np.cos(angle), np.sin(angle)], axis=1) / np.cos(np.pi / sides)


def tray(inner: Sequence[float], thickness: float, floor: float, height: float) -> list[trimesh.Trimesh]:
    """Floor and four walls of an open box around the origin, standing at z = 0.

    Args:
        inner: (2,) free size inside.
        thickness: of the walls.
        floor: thickness of the floor.
        height: of the rim.
    """
    x, y = inner
    outer_x = x + 2 * thickness
    pieces = [solids.box((outer_x, y + 2 * thickness, floor), (0, 0, 0))]
    for sign in (-1, 1):
        pieces.append(solids.box((thickness, y, height - floor), (sign * (x + thickness) / 2, 0, floor)))
        pieces.append(solids.box((outer_x, thickness, height - floor), (0, sign * (y + thickness) / 2, floor)))
    return pieces


def across(corners: ArrayLike, width: float) -> Piece:
    """The convex prism across x, centred, through corners (n, 2) of y and z in any order."""
    outline = np.asarray(corners, dtype=np.float64)
    return hull(*[np.column_stack([np.full(len(outline), x), outline]) for x in (-width / 2, width / 2)])


def chain(sections: Sequence[ArrayLike]) -> list[Piece]:
    """Hulls of each two consecutive point sets (k, 3): for things that bend."""
    return [hull(a, b) for a, b in itertools.pairwise(sections)]


def slabs(solid: trimesh.Trimesh, count: int, axis: int = 0) -> list[Piece]:
    """The hulls of ``count`` equal slices of a solid along an axis: for lumps that are convex across it.

    Args:
        solid: the lump.
        count: of slices.
        axis: 0, 1 or 2.
    """
    low, high = solid.bounds[:, axis]
    limits = np.linspace(low, high, count + 1)
    normal = np.eye(3)[axis]
    out = []
    for start, end in itertools.pairwise(limits):
        sliced = solid.slice_plane(start * normal, normal).slice_plane(end * normal, -normal)
        out.append(coarse(sliced.vertices))
    return out


def coarse(points: ArrayLike, directions: int = 60) -> Piece:
    """The hull of the points that are farthest in some evenly spread directions: few corners, all of the input."""
    points = np.asarray(points, dtype=np.float64)
    index = np.arange(directions) + 0.5
    height, turn = 1 - 2 * index / directions, index * np.pi * (1 + 5**0.5)
    flat = np.sqrt(1 - height**2)
    spread = np.column_stack([flat * np.cos(turn), flat * np.sin(turn), height])
    spread = np.concatenate([spread, np.eye(3), -np.eye(3)])
    tilted = spread[-6:, None] + 1e-3 * spread[None, :-6:4]  # all corners of flat sides, not one of them
    spread = np.concatenate([spread, tilted.reshape(-1, 3)])
    return hull(points[np.unique((points @ spread.T).argmax(axis=0))])
