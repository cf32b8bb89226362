"""A serving tray with a low lip and two grips."""

from __future__ import annotations

from assets.shapes.open_box import open_shell
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("tray", variant)
    inner, wall, floor, height = (0.28, 0.19), 0.007, 0.005, 0.02
    shell = open_shell(inner, wall, floor, height, rounding=0.012)
    hulls = pieces.tray(inner, wall, floor, height)
    grips = []
    for side in (-1, 1):
        middle = side * (inner[0] / 2 + wall / 2)
        grips.append(solids.rounded_box((0.012, 0.085, 0.014), 0.004, (middle, 0, height - 0.002)))
    body = solids.union(shell, *grips)
    hulls += [grip.convex_hull for grip in grips]
    if variant == "wood":
        part = paint(body, materials.wood(rng, materials.BEECH), tiled(0.16), roughness=0.6)
    else:
        part = paint(body, materials.plastic(rng, (74, 92, 108)), tiled(0.1), roughness=0.5)
    return BuiltObject([part], hulls, mass=0.6, friction=0.6)
