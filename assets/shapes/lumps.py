"""Grown and turned things: smooth profiles, lobed bodies, a flat underside, and a mapping for domes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import PchipInterpolator

from vcage.objects.modelling import pieces, solids
from vcage.objects.modelling.parts import Mapping


def smooth(knots: ArrayLike, count: int = 24) -> np.ndarray:
    """Points (count, 2) on a curve through knots (n, 2) that does not swing beyond them."""
    knots = np.asarray(knots, dtype=np.float64)
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(knots, axis=0), axis=1))])
    return PchipInterpolator(length, knots)(np.linspace(0, length[-1], count))


def lobed(profile: ArrayLike, lobes: int = 5, depth: ArrayLike = 0.0, count: int = 40) -> solids.Solid:
    """An upright body whose radius has grooves.

    Args:
        profile: (n, 2) radius and z from one end to the other; both ends are closed.
        lobes: how many bulges around.
        depth: of the grooves between them as a share of the radius; one number, or (n,) one per profile point.
        count: points around.
    """
    profile = np.asarray(profile, dtype=np.float64)
    angle = np.arange(count) * 2 * np.pi / count
    groove = 1 - np.abs(np.sin(lobes * angle / 2)) ** 0.7  # 1 in a groove, 0 on a bulge
    depth = np.broadcast_to(np.asarray(depth, dtype=np.float64), len(profile))
    radius = profile[:, :1] * (1 - depth[:, None] * groove[None])  # (n, count)
    z = np.broadcast_to(profile[:, 1:], radius.shape)
    return solids.closed_rings(np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=-1))


def lying(solid: solids.Solid, sink: float) -> solids.Solid:
    """An upright body laid down along x, its top to the right, with a flat underside.

    Args:
        solid: as it stands.
        sink: how much of its lower side is cut away, metres.
    """
    out = solids.moved(solid, turn=90, axis=(0, 1, 0))
    out.apply_translation((0, 0, -float(out.bounds[0, 2]) - sink))
    return solids.above(out, 0.0)


def standing(body: solids.Solid, foot: float) -> pieces.Piece:
    """A hull with a flat foot of the given radius, so that round things do not roll."""
    return pieces.hull(pieces.coarse(body.vertices).vertices, pieces.stack([(foot, 0), (foot, 0.001)]).vertices)


def over_dome(centre: ArrayLike, reach: float = 120.0) -> Mapping:
    """The picture lies on a dome without streaks: distance from its middle is the angle from straight up.

    Args:
        centre: (3,) where the angle is measured.
        reach: the angle in degrees that the picture's nearest edges stand for.
    """
    centre = np.asarray(centre, dtype=np.float64)

    def mapping(corners: np.ndarray, _normals: np.ndarray) -> np.ndarray:
        offset = corners - centre
        flat = np.linalg.norm(offset[..., :2], axis=-1)
        share = np.degrees(np.arctan2(flat, offset[..., 2])) / reach
        way = offset[..., :2] / np.maximum(flat, 1e-9)[..., None]
        return np.clip(0.5 + 0.5 * share[..., None] * way, 0.0, 1.0)

    return mapping


def over_ring(radius: float, height: float) -> Mapping:
    """The picture is spread over a lying ring without streaks, as a disc.

    Half-way from the disc's middle to its rim is the ring's top, the rim is its underside reached over the outside,
    the middle its underside reached through the hole.

    Args:
        radius, height: of the middle line of the tube, metres.
    """

    def mapping(corners: np.ndarray, _normals: np.ndarray) -> np.ndarray:
        flat = np.linalg.norm(corners[..., :2], axis=-1)
        around = np.degrees(np.arctan2(corners[..., 2] - height, flat - radius))  # 0 outside, 90 on top, 180 inside
        share = 1 - ((around + 90) % 360) / 360
        way = corners[..., :2] / np.maximum(flat, 1e-9)[..., None]
        return 0.5 + 0.5 * share[..., None] * way

    return mapping
