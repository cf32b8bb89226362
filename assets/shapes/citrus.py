"""Lying citrus fruit."""

from __future__ import annotations

import numpy as np

from assets.shapes import lumps
from assets.textures import foods
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint


def citrus(
    rng: np.random.Generator, colour: tuple[int, int, int], scale: tuple[float, float], mass: float
) -> BuiltObject:
    """A lying citrus fruit with a nipple to the right; ``scale`` is across and along, 1 for a lemon.

    Args:
        rng: for unevenness and peel.
        colour: of the peel.
        scale: of a lemon, across and along.
        mass: kilograms.
    """
    knots = [(0.0025, -0.0375), (0.0065, -0.0365), (0.0105, -0.0335), (0.0195, -0.0255), (0.0258, -0.009)]
    knots += [(0.0265, 0.003), (0.0225, 0.0175), (0.0145, 0.027), (0.0085, 0.0315), (0.0065, 0.0355), (0.002, 0.0375)]
    body = lumps.lobed(lumps.smooth(np.array(knots) * scale, 34), count=36)
    body = lumps.lying(solids.displaced(body, 0.0003, 0.012, rng), 0.001)
    height = float(body.bounds[1, 2])
    knob = solids.revolved([(0, 0), (0.0026, 0), (0.002, 0.0016), (0, 0.002)], 10)
    knob = solids.moved(knob, (float(body.bounds[0, 0]) + 0.0008, 0, height / 2), turn=-90, axis=(0, 1, 0))
    parts = [
        paint(body, foods.peel(rng, colour), tiled(0.05), roughness=0.42),
        paint(knob, materials.plastic(rng, (112, 124, 60)), tiled(0.05), roughness=0.8),
    ]
    return BuiltObject(parts, pieces.slabs(body, 3), mass=mass, friction=0.7)
