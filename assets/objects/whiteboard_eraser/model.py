"""A plastic grip over a felt pad."""

from __future__ import annotations

from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"blue": (40, 92, 168), "grey": (88, 92, 98)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("whiteboard_eraser", variant)
    colour = COLOURS[variant]
    felt = solids.rounded_box((0.106, 0.047, 0.013), 0.001)
    grip = solids.rounded_box((0.112, 0.052, 0.02), 0.006, (0, 0, 0.012))
    top = prints.text(materials.plastic(rng, colour, 256), "ERASER", (0.5, 0.5), 0.2, (240, 240, 240))
    parts = [
        paint(felt, materials.felt(rng, (60, 60, 64)), tiled(0.04), roughness=0.95),
        paint(grip, top, from_above(), roughness=0.45),
    ]
    return BuiltObject(parts, [felt.convex_hull, pieces.coarse(grip.vertices)], mass=0.06, friction=0.8)
