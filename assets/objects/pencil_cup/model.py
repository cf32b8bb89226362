"""An empty cup for pens, ribbed outside."""

from __future__ import annotations

from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("pencil_cup", variant)
    radius, height, wall, floor = 0.0345, 0.09, 0.003, 0.005
    profile = [(0, 0), (radius - 0.001, 0), (radius, 0.002), (radius, height - 0.001), (radius - 0.001, height)]
    profile += [(radius - wall, height), (radius - wall, floor), (0, floor)]
    body = solids.revolved(profile, 44)
    if variant == "bamboo":
        part = paint(body, materials.wood(rng, materials.PINE), tiled(0.1, along=2), roughness=0.7)
    else:
        part = paint(body, materials.felt(rng, (70, 78, 92)), tiled(0.05), roughness=0.7)
    hulls = [pieces.stack([(radius, 0), (radius, floor)])]
    hulls += pieces.ring([(radius - wall, floor), (radius, floor), (radius, height), (radius - wall, height)])
    return BuiltObject([part], hulls, mass=0.12, friction=0.6)
