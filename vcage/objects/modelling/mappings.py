"""Texture mappings, from corner positions to texture coordinates: :data:`vcage.objects.modelling.parts.Mapping`."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from vcage.objects.modelling.parts import Mapping


def tiled(period: float, *, along: int = 0) -> Mapping:
    """Each face takes the picture from the axis it faces; the picture repeats every ``period`` metres.

    Args:
        along: the axis (0, 1, 2) that the picture's rows follow where a face contains it, e.g. the grain of wood.
    """

    def mapping(corners: np.ndarray, normals: np.ndarray) -> np.ndarray:
        facing = np.abs(normals).argmax(axis=1)
        uv = np.empty((*corners.shape[:2], 2))
        for axis in range(3):
            u = next(a for a in (along, *range(3)) if a != axis)
            v = next(a for a in range(3) if a not in (axis, u))
            rows = facing == axis
            uv[rows] = corners[rows][..., [u, v]] / period
        return uv

    return mapping


def from_above() -> Mapping:
    """The picture lies over the bounding rectangle as seen from above, right side to +x."""

    def mapping(corners: np.ndarray, _normals: np.ndarray) -> np.ndarray:
        return np.stack([_stretched(corners[..., 0]), _stretched(corners[..., 1])], axis=-1)

    return mapping


def from_front() -> Mapping:
    """The picture lies over the bounding rectangle as seen from the front (from -y)."""

    def mapping(corners: np.ndarray, _normals: np.ndarray) -> np.ndarray:
        return np.stack([_stretched(corners[..., 0]), _stretched(corners[..., 2])], axis=-1)

    return mapping


def around(axis: int = 2, centre: tuple[float, float] = (0.0, 0.0)) -> Mapping:
    """The picture is wrapped once around an axis: u is the angle, v the position along the axis.

    The middle of the picture faces -y for the vertical axis, and up for the others.

    Args:
        centre: where the axis crosses the plane of the two other coordinates.
    """
    first, second = [(1, 2), (0, 2), (0, 1)][axis]

    def mapping(corners: np.ndarray, _normals: np.ndarray) -> np.ndarray:
        a, b = corners[..., first] - centre[0], corners[..., second] - centre[1]
        turned = np.arctan2(*((-a, b), (a, b), (a, -b))[axis])  # 0 in the middle of the picture; never mirrored
        u = turned / (2 * np.pi) + 0.5
        on_axis = np.hypot(a, b) < 1e-7
        middle = np.where(on_axis, np.nan, u)
        reference = np.nanmin(np.where(np.isnan(middle), np.inf, middle), axis=1, keepdims=True)
        wraps = (np.nanmax(np.where(np.isnan(middle), -np.inf, middle), axis=1, keepdims=True) - reference) > 0.5
        u = np.where(wraps & (u < 0.5), u + 1, u)
        others = np.where(on_axis, 0, u).sum(axis=1, keepdims=True) / np.maximum(
            (~on_axis).sum(axis=1, keepdims=True), 1
        )
        return np.stack([np.where(on_axis, others, u), _stretched(corners[..., axis])], axis=-1)

    return mapping


ATLAS = {"front": (0, 1), "right": (1, 1), "back": (2, 1), "left": (0, 0), "top": (1, 0), "bottom": (2, 0)}
"""Cell (column, row from below) of each side in the 3 × 2 atlas of :func:`six_sides`."""


def six_sides() -> Mapping:
    """Each side of the bounding box has its own cell in a 3 × 2 picture (see :data:`ATLAS`)."""

    def mapping(corners: np.ndarray, normals: np.ndarray) -> np.ndarray:
        x, y, z = (_stretched(corners[..., i]) for i in range(3))
        facing = np.abs(normals).argmax(axis=1)
        positive = normals[np.arange(len(normals)), facing] > 0
        sides = {
            "front": ((facing == 1) & ~positive, x, z),
            "back": ((facing == 1) & positive, 1 - x, z),
            "left": ((facing == 0) & ~positive, 1 - y, z),
            "right": ((facing == 0) & positive, y, z),
            "top": ((facing == 2) & positive, x, y),
            "bottom": ((facing == 2) & ~positive, x, 1 - y),
        }
        uv = np.empty((*corners.shape[:2], 2))
        for side, (rows, u, v) in sides.items():
            column, row = ATLAS[side]
            inset = 0.004  # keeps filtering from mixing neighbouring cells
            cell = np.stack([u[rows], v[rows]], axis=-1) * (1 - 2 * inset) + inset
            uv[rows] = np.add(cell, (column, row)) / (3, 2)
        return uv

    return mapping


def _stretched(values: np.ndarray) -> np.ndarray:
    """Scaled so that the values run from 0 to 1."""
    low, high = values.min(), values.max()
    return (values - low) / max(high - low, 1e-9)


def along(path: np.ndarray) -> Mapping:
    """The picture's columns follow a path (n, 3), by its points' numbers; its rows run from the bottom up."""
    count = len(path)

    def mapping(corners: np.ndarray, _normals: np.ndarray) -> np.ndarray:
        nearest = KDTree(path[:, :2]).query(corners[..., :2])[1]
        return np.stack([nearest / (count - 1), _stretched(corners[..., 2])], axis=-1)

    return mapping
