"""A small drink bottle with a screw cap."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "juice": ((240, 150, 40), (250, 250, 246), "ORANGE"),
    "water": ((178, 212, 230), (40, 110, 180), "WATER"),
}
"""Variant → drink, ground, words."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("bottle", variant)
    drink, ground, words = VARIANTS[variant]
    radius, shoulder, height = 0.03, 0.10, 0.142
    body = [(0, 0.002), (0.022, 0), (radius - 0.002, 0.001), (radius, 0.005), (radius, shoulder)]
    neck = solids.arc((0.013, shoulder), (radius - 0.013, 0.026), 8, 90, 7)
    body = np.concatenate([body, neck, [(0.0125, height - 0.014), (0, height - 0.014)]])
    cap = solids.revolved(
        [(0, height - 0.017), (0.0145, height - 0.017), (0.0145, height - 0.001), (0.0135, height), (0, height)], 24
    )
    band = solids.revolved([(0.02, 0.032), (radius + 0.0003, 0.032), (radius + 0.0003, 0.082), (0.02, 0.082)], 36)
    label = prints.canvas(512, 144, ground)
    ink = (226, 110, 20) if variant == "juice" else (250, 250, 250)
    for x in (0.0, 0.5, 1.0):
        label = prints.text(label, words, (x, 0.42), 0.24, ink)
        label = prints.rectangle(label, (max(0, x - 0.12), 0.68), (min(1, x + 0.12), 0.74), ink)
    parts = [
        paint(solids.revolved(body, 36), materials.plastic(rng, drink), tiled(0.08), roughness=0.15),
        paint(
            cap,
            materials.plastic(rng, (40, 130, 70) if variant == "juice" else (36, 84, 160)),
            tiled(0.05),
            roughness=0.4,
        ),
        paint(band, label, around(), roughness=0.5),
    ]
    hulls = [
        pieces.stack(
            [(radius, 0), (radius + 0.0003, 0.032), (radius + 0.0003, shoulder), (0.025, 0.1195), (0.0145, 0.126)]
        ),
        pieces.stack([(0.0145, 0.12), (0.0145, height)]),
    ]
    return BuiltObject(parts, hulls, mass=0.33, friction=0.6)
