"""An orange or a tangerine, slightly flat at both poles."""

from __future__ import annotations

from assets.shapes.lumps import standing
from assets.textures import foods
from vcage.objects.modelling import materials, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"orange": (238, 140, 30), "tangerine": (236, 110, 28)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("orange", variant)
    colour = COLOURS[variant]
    flat = 0.031 if variant == "orange" else 0.027
    body = solids.ellipsoid((0.033, 0.033, flat), (0, 0, flat - 0.0012), 32)
    body = solids.above(body, 0.0)
    navel = solids.revolved([(0, 0), (0.003, 0), (0.0024, 0.0012), (0, 0.0014)], 10)
    navel = solids.moved(navel, (0, 0, float(body.bounds[1, 2]) - 0.0004))
    parts = [
        paint(body, foods.peel(rng, colour), tiled(0.06), roughness=0.5),
        paint(navel, materials.plastic(rng, (96, 120, 52)), tiled(0.05), roughness=0.8),
    ]
    return BuiltObject(parts, [standing(body, 0.012)], mass=0.17, friction=0.7)
