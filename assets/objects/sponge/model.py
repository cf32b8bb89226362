"""A soft sponge with a scouring side at the bottom."""

from __future__ import annotations

from vcage.objects.modelling import materials, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"yellow": (244, 206, 70), "blue": (104, 172, 220)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("sponge", variant)
    colour = COLOURS[variant]
    soft = solids.rounded_box((0.096, 0.062, 0.026), 0.004, (0, 0, 0.007))
    rough = solids.box((0.094, 0.06, 0.009))
    holes = materials.speckled(rng, colour, tuple(int(0.62 * c) for c in colour), 0.10)
    parts = [
        paint(soft, holes, tiled(0.07), roughness=0.95),
        paint(rough, materials.felt(rng, (44, 104, 62)), tiled(0.04), roughness=0.95),
    ]
    # Damp, it slides over a mat; with a coefficient of 0.9 it takes the mat along.
    return BuiltObject(parts, [soft.convex_hull, rough], mass=0.02, friction=0.5)
