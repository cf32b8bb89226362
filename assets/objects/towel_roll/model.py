"""A rolled-up hand towel that lies along x."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import lofts, pieces, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.parts import BuiltObject, Mapping, paint, variant_rng

VARIANTS = {
    "white": ((244, 242, 236), (150, 176, 196)),
    "teal": ((44, 138, 142), (232, 238, 232)),
    "rose": ((222, 150, 156), (246, 232, 226)),
}
"""Variant → colour, band."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("towel_roll", variant)
    colour, band = VARIANTS[variant]
    radius, half = 0.034, 0.082
    ring = solids.circle(radius, 44)
    ring[:, 1] = np.maximum(ring[:, 1], 0.0025 - radius)  # lies flat
    stations = [(-half, 0.9), (-half + 0.004, 1.0), (half - 0.004, 1.0), (half, 0.9)]
    rings = [np.column_stack([np.full(44, x), ring * s]) + (0, 0, radius - 0.0025) for x, s in stations]
    roll = solids.closed_rings(rings)
    flat = np.abs(roll.face_normals[:, 0]) > 0.9
    ends, wrap = roll.copy(), roll.copy()
    ends.update_faces(flat)
    wrap.update_faces(~flat)
    cloth = packaging.terry(rng, colour)
    cloth = np.tile(cloth, (1, 2, 1))
    for low, high in ((0.1, 0.13), (0.15, 0.19), (0.21, 0.24), (0.76, 0.79), (0.81, 0.85), (0.87, 0.9)):
        cloth[round(low * 256) : round(high * 256)] = (
            0.25 * cloth[round(low * 256) : round(high * 256)] + 0.75 * np.asarray(band)
        ).astype(np.uint8)
    flap = [solids.circle(radius + 0.0012, 88)[8:18], solids.circle(radius - 0.001, 88)[8:18][::-1]]
    hem = lofts.across(np.concatenate(flap) + (0, radius - 0.0025), 2 * half - 0.01)
    parts = [
        paint(wrap, cloth, around(0, (0.0, radius - 0.0025)), roughness=0.95),
        paint(ends, packaging.windings(colour, 7, 0.55), _end_on(), roughness=0.95),
        paint(hem, packaging.terry(rng, tuple(int(0.92 * c) for c in colour)), tiled(0.06), roughness=0.95),
    ]
    return BuiltObject(parts, [pieces.hull(*[r[::2] for r in rings])], mass=0.15, friction=0.9)


def _end_on() -> Mapping:
    """The picture lies over the bounding rectangle as seen along x."""

    def mapping(corners: np.ndarray, _normals: np.ndarray) -> np.ndarray:
        flat = corners[..., 1:]
        low, high = flat.reshape(-1, 2).min(axis=0), flat.reshape(-1, 2).max(axis=0)
        return (flat - low) / (high - low)

    return mapping
