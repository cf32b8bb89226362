"""A screwdriver along x, blade to the left; its handle has six sides and lies flat."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import lofts, materials, pieces, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "red": ((206, 32, 36), (36, 36, 40)),
    "yellow": ((246, 190, 24), (36, 36, 40)),
    "blue": ((28, 92, 180), (240, 200, 40)),
}
"""Variant → grip, collar."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("screwdriver", variant)
    grip, collar = VARIANTS[variant]
    angle = np.arange(42) * 2 * np.pi / 42
    flutes = (1 - 0.075 * (0.5 + 0.5 * np.cos(6 * angle)) ** 2)[:, None]
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1) * flutes
    low = -float(ring[:, 1].min())
    ring[:, 1] = np.maximum(ring[:, 1], -0.88 * low)
    radius, axis = 0.0155, 0.0155 * 0.88 * low
    stations = [(0.0, 0.62), (0.004, 0.8), (0.014, 0.82), (0.024, 1.0), (0.086, 1.0), (0.096, 0.94), (0.1, 0.72)]
    rings = [np.column_stack([np.full(42, x), ring * radius * s + (0, axis)]) for x, s in stations]
    handle = solids.closed_rings(rings)
    shaft = lofts.rod(0.0034, -0.078, 0.002, axis, 20)
    blade = pieces.hull(
        [(-0.098, y, axis + z) for y in (-0.0038, 0.0038) for z in (-0.0007, 0.0007)],
        [(-0.086, y, axis + z) for y in (-0.0042, 0.0042) for z in (-0.0015, 0.0015)],
        [(-0.0765, y, axis + z) for y in (-0.003, 0.003) for z in (-0.003, 0.003)],
    )
    stripes = np.tile(np.asarray(grip, dtype=np.uint8), (64, 256, 1))
    picture = packaging.striped([grip, grip, collar], 18)
    picture = np.concatenate([stripes[:14], np.repeat(picture, 2, axis=0)[:40], stripes[:10]])
    cuff = lofts.rod(0.0105, -0.001, 0.006, axis, 24)
    parts = [
        paint(handle, picture, around(0, (0.0, axis)), roughness=0.35, crease=25),
        paint(cuff, materials.plastic(rng, collar), tiled(0.05), roughness=0.5),
        paint(solids.union(shaft, blade), materials.brushed(rng), tiled(0.05), roughness=0.25, metallic=0.5),
    ]
    hulls = [
        pieces.hull(*rings[3:]),
        pieces.hull(*rings[:4]),
        pieces.hull(shaft.vertices[::2]),
        blade,
    ]
    return BuiltObject(parts, hulls, mass=0.11, friction=0.7)
