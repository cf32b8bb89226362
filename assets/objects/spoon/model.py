"""A cooking spoon that lies along x, bowl to the left, handle thick enough to be picked up."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("spoon", variant)
    x = np.linspace(0.018, 0.1, 12)
    path = np.stack([x, np.zeros(12), np.linspace(0.0085, 0.008, 12)], axis=1)
    width = np.interp(x, [0.018, 0.05, 0.09, 0.1], [0.7, 0.9, 1.1, 0.8])
    handle = solids.sweep(path, solids.circle(1.0, 16) * (0.007, 0.0075), width)
    ladle = solids.moved(solids.ellipsoid((0.032, 0.021, 0.011), count=28), (-0.004, 0, 0.011))
    hollow = solids.moved(solids.ellipsoid((0.028, 0.017, 0.009), count=28), (-0.005, 0, 0.0155))
    ladle = solids.cut(ladle, hollow, solids.box((0.2, 0.2, 0.1), (0, 0, 0.0155)))
    body = solids.union(ladle, handle)
    low = float(body.bounds[0, 2])
    if variant == "wood":
        part = paint(body, materials.wood(rng, materials.BEECH), tiled(0.12), roughness=0.7)
    else:
        part = paint(body, materials.brushed(rng), tiled(0.1), roughness=0.35, metallic=0.3)
    block_ = pieces.coarse(solids.cut(ladle, solids.box((0.2, 0.2, 0.1), (0, 0, 0.013))).vertices)
    bar = handle.convex_hull
    base = pieces.hull(*[[(0.02, y, low), (0.1, y, low), (0.02, y, 0.006), (0.1, y, 0.006)] for y in (-0.005, 0.005)])
    return BuiltObject([part], [block_, bar, base], mass=0.05, friction=0.7)
