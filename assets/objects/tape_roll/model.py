"""A roll of packing tape that lies flat, with its cardboard core."""

from __future__ import annotations

from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"brown": (176, 132, 78), "blue": (50, 110, 190)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("tape_roll", variant)
    colour = COLOURS[variant]
    outer, middle, inner, height = 0.0335, 0.0225, 0.0205, 0.024
    tape = solids.revolved([(middle, 0), (outer, 0), (outer, height), (middle, height)], 44)
    core = solids.revolved([(inner, 0), (middle, 0), (middle, height + 0.0004), (inner, height + 0.0004)], 44)
    windings = prints.canvas(256, 256, colour)
    for i in range(13):
        ring_colour = tuple(int(c * (0.86 if i % 2 else 1.0)) for c in colour)
        windings = prints.disc(windings, (0.5, 0.5), 0.5 - 0.0125 * i, ring_colour)
    parts = [
        paint(tape, windings, from_above(), roughness=0.3),
        paint(core, materials.cardboard(rng), tiled(0.1), roughness=0.9),
    ]
    return BuiltObject(
        parts, pieces.ring([(inner, 0), (outer, 0), (outer, height), (inner, height)]), mass=0.09, friction=0.7
    )
