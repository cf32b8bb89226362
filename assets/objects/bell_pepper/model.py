"""A bell pepper with four lobes, 0.068 m across, standing on them."""

from __future__ import annotations

import numpy as np

from assets.shapes import lumps
from assets.shapes.stalk import LEAF, stalk
from assets.textures import foods
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "red": ((178, 18, 22), (206, 34, 28)),
    "yellow": ((240, 182, 24), (252, 206, 48)),
    "green": ((52, 112, 40), (86, 148, 56)),
}
"""Variant → low, high."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("bell_pepper", variant)
    low, high = VARIANTS[variant]
    knots = [
        (0.002, 0.006),
        (0.008, 0.0035),
        (0.016, 0),
        (0.024, 0.003),
        (0.0285, 0.012),
        (0.032, 0.032),
        (0.034, 0.052),
    ]
    knots += [(0.032, 0.062), (0.025, 0.0685), (0.016, 0.0675), (0.009, 0.0625), (0.002, 0.061)]
    profile = lumps.smooth(knots, 34)
    body = lumps.lobed(profile, 4, np.interp(profile[:, 1], [0, 0.012, 0.05, 0.068], [0.16, 0.1, 0.09, 0.16]), 56)
    body = solids.above(solids.displaced(body, 0.0008, 0.05, rng), float(body.bounds[0, 2]) + 0.0008)
    calyx = solids.revolved([(0, 0.058), (0.011, 0.0615), (0.0125, 0.0645), (0.006, 0.0655), (0, 0.066)], 16)
    stem = stalk([(0, 0, 0.063), (0.0006, 0, 0.07), (0.002, 0, 0.078), (0.005, 0, 0.084)], 0.0042, LEAF, rng)
    parts = [
        paint(body, foods.glossy_skin(rng, low, high), around(), roughness=0.18),
        paint(calyx, materials.plastic(rng, LEAF), tiled(0.03), roughness=0.7),
        stem,
    ]
    hulls = [lumps.standing(body, 0.019), pieces.coarse(stem.vertices, 24)]
    return BuiltObject(parts, hulls, mass=0.15, friction=0.6)
