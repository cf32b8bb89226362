"""Solids drawn through sections: bodies of scaled outlines, lying prisms, rods, and their convex pieces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from vcage.objects.modelling import pieces, solids

Level = tuple[float, float] | tuple[float, float, float]
"""A height and the factor of the outline there; two factors, along x and y, when they differ."""


def levelled(outline: ArrayLike, levels: Sequence[Level]) -> solids.Solid:
    """An upright solid whose sections are an outline (n, 2) scaled about the z axis."""
    return solids.closed_rings(_rings(outline, levels))


def levelled_hull(outline: ArrayLike, levels: Sequence[Level]) -> pieces.Piece:
    """The convex hull of :func:`levelled` with every other corner left out.

    The corners of the hull lie on the solid, so it is smaller by less than the height of an arc over two sides.
    """
    return pieces.hull(_rings(np.asarray(outline)[::2], levels))


def _rings(outline: ArrayLike, levels: Sequence[Level]) -> np.ndarray:
    """(levels, n, 3) corners."""
    outline = np.asarray(outline, dtype=np.float64)
    return np.stack([np.column_stack([outline * np.asarray(scale), np.full(len(outline), z)]) for z, *scale in levels])


def across(outline: ArrayLike, width: float) -> solids.Solid:
    """A prism along x, centred: ``outline`` (n, 2) gives y and z, counter-clockwise as seen from the right."""
    upright = solids.prism(outline, width, -width / 2)  # y, z, x
    return _turned(upright, [2, 0, 1])


def along_y(outline: ArrayLike, depth: float) -> solids.Solid:
    """A prism along y, centred: ``outline`` (n, 2) gives z and x, counter-clockwise as seen from behind."""
    return _turned(solids.prism(outline, depth, -depth / 2), [1, 2, 0])


def _turned(solid: solids.Solid, order: list[int]) -> solids.Solid:
    """The solid with its coordinates in another cyclic order, which keeps it right-handed."""
    out = solid.copy()
    out.vertices = solid.vertices[:, order]
    return out


def rod(radius: float, start: float, end: float, z: float, sides: int = 24, bevel: float = 0.0015) -> solids.Solid:
    """A round bar along x at the height ``z``, with bevelled ends.

    Args:
        radius: metres.
        start, end: where it begins and ends along x.
        z: height of its axis.
        sides: of its section.
        bevel: how far its ends are bevelled.
    """
    ring = solids.circle(1.0, sides)
    stations = [(start, radius - bevel), (start + bevel, radius), (end - bevel, radius), (end, radius - bevel)]
    return solids.closed_rings(
        [np.column_stack([np.full(sides, x), ring[:, 0] * r, ring[:, 1] * r + z]) for x, r in stations]
    )
