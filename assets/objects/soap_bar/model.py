"""A bar of soap with a pressed word."""

from __future__ import annotations

from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_above
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"lavender": (196, 176, 222), "olive": (176, 190, 130)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("soap_bar", variant)
    colour = COLOURS[variant]
    bar = solids.rounded_box((0.084, 0.054, 0.028), 0.011, steps=5)
    dark = tuple(int(0.78 * c) for c in colour)
    top = prints.text(materials.plastic(rng, colour, 256), "SOAP", (0.5, 0.5), 0.27, dark)
    return BuiltObject([paint(bar, top, from_above(), roughness=0.35)], [pieces.coarse(bar.vertices, 90)], 0.1, 0.6)
