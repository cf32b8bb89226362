"""A rubber in a paper sleeve."""

from __future__ import annotations

from vcage.objects.modelling import materials, prints, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"white": (242, 240, 236), "pink": (236, 146, 150)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("rubber_eraser", variant)
    colour = COLOURS[variant]
    rubber = solids.rounded_box((0.056, 0.024, 0.018), 0.003)
    sleeve = solids.box((0.034, 0.0248, 0.0186), (-0.008, 0, 0))
    print_ = prints.canvas(256, 192, (34, 70, 150))
    print_ = prints.rectangle(print_, (0, 0.0), (1, 0.18), (240, 240, 240))
    print_ = prints.text(print_, "rubber", (0.5, 0.56), 0.3)
    parts = [
        paint(rubber, materials.plastic(rng, colour), tiled(0.05), roughness=0.8),
        paint(sleeve, print_, from_above(), roughness=0.7),
    ]
    return BuiltObject(parts, [rubber.convex_hull, sleeve], mass=0.025, friction=0.9)
