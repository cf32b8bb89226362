"""A rolling pin along x, 0.3 m long, with a narrow flat underside so that it does not roll."""

from __future__ import annotations

import numpy as np

from assets.shapes import lumps
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.noise import blend, clouds, over
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"beech": materials.BEECH, "walnut": materials.WALNUT, "marble": materials.WALNUT}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("rolling_pin", variant)
    radius, half = 0.024, 0.095
    edge = solids.arc((radius - 0.004, half - 0.004), 0.004, 0, 90, 5)
    barrel = solids.revolved(np.concatenate([[(0, -half)], edge[::-1] * (1, -1), edge, [(0, half)]]), 40)
    knots = [(0.0075, half - 0.001), (0.0075, half + 0.004), (0.0115, half + 0.014), (0.0135, half + 0.03)]
    knots += [(0.0125, half + 0.045), (0.0085, half + 0.053), (0.003, half + 0.055)]
    shape = lumps.smooth(knots, 16)
    handle = solids.revolved(np.concatenate([[(0, shape[0, 1])], shape, [(0, shape[-1, 1])]]), 28)
    body = lumps.lying(barrel, 0.0012)
    colours = COLOURS[variant]
    grain = materials.wood(rng, colours)
    skin, roughness = (_marble(rng), 0.2) if variant == "marble" else (grain, 0.6)
    height = radius - 0.0012
    parts, hulls = [paint(body, skin, tiled(0.12), roughness=roughness)], [pieces.coarse(body.vertices, 90)]
    for side in (-1, 1):
        grip = solids.moved(handle, (0, 0, height), turn=90 * side, axis=(0, 1, 0))
        parts.append(paint(grip, grain, tiled(0.12), roughness=0.55))
        hulls += pieces.slabs(grip, 2)
    return BuiltObject(parts, hulls, mass=0.55 if variant == "marble" else 0.4, friction=0.6)


def _marble(rng: np.random.Generator, size: int = 256) -> np.ndarray:
    """White marble with grey veins."""
    shape = (size, size)
    veins = 1 - np.abs(clouds(rng, shape, (2, 3), 5) - 0.5) * 34
    picture = blend((242, 241, 238), (222, 222, 222), clouds(rng, shape, (3, 3)))
    return over(picture, (140, 142, 148), np.clip(veins, 0, 1) * 0.7)
