"""A standing tube with a cap."""

from __future__ import annotations

from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

CAP_COLOURS = {"white": (236, 236, 230), "orange": (238, 128, 36)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("glue_stick", variant)
    cap_colour = CAP_COLOURS[variant]
    body = solids.revolved([(0, 0), (0.0135, 0), (0.0135, 0.006), (0.0128, 0.007), (0.0128, 0.06), (0, 0.06)], 28)
    cap = solids.revolved([(0, 0.058), (0.0137, 0.058), (0.0137, 0.084), (0.0122, 0.087), (0, 0.087)], 28)
    label = prints.canvas(256, 192, (250, 206, 40))
    label = prints.rectangle(label, (0, 0.82), (1, 1), (40, 66, 140))
    for x in (0.17, 0.5, 0.83):
        label = prints.text(label, "GLUE", (x, 0.42), 0.24, (40, 66, 140))
    parts = [
        paint(body, label, around(), roughness=0.45),
        paint(cap, materials.plastic(rng, cap_colour), tiled(0.05), roughness=0.4),
    ]
    return BuiltObject(parts, [pieces.stack([(0.0137, 0), (0.0137, 0.084), (0.0122, 0.087)])], mass=0.035)
