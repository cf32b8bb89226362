"""An oval bottle with a flip cap, wide face to the front."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {"mint": ((150, 208, 186), "LOTION"), "peach": ((246, 186, 150), "SHAMPOO")}
"""Variant → ground, words."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("lotion_bottle", variant)
    ground, words = VARIANTS[variant]
    height, shoulder = 0.135, 0.098
    levels = [
        (0, 0.94),
        (0.003, 1.0),
        (shoulder - 0.02, 1.0),
        (shoulder - 0.008, 0.93),
        (shoulder, 0.72),
        (shoulder + 0.003, 0.5),
    ]
    outline = solids.circle(1.0, 36) * (0.031, 0.02)
    body = solids.closed_rings([np.column_stack([outline * s, np.full(36, z)]) for z, s in levels])
    cap = solids.revolved(
        [(0, shoulder), (0.0145, shoulder), (0.0145, height - 0.003), (0.0125, height), (0, height)], 28
    )
    label = materials.plastic(rng, ground, 256)
    dark = tuple(int(0.45 * c) for c in ground)
    for x in (0.0, 0.5, 1.0):
        label = prints.rectangle(label, (max(0, x - 0.15), 0.25), (min(1, x + 0.15), 0.80), (250, 248, 244))
        label = prints.text(label, words, (x, 0.48), 0.075, dark)
        label = prints.rectangle(label, (max(0, x - 0.08), 0.58), (min(1, x + 0.08), 0.6), dark)
    parts = [
        paint(body, label, around(), roughness=0.35),
        paint(cap, materials.plastic(rng, (246, 246, 244)), tiled(0.05), roughness=0.35),
    ]
    rings = [np.column_stack([outline[::2] * s, np.full(18, z)]) for z, s in levels]
    lid = pieces.stack([(0.0145, shoulder), (0.0145, height - 0.003), (0.0125, height)])
    return BuiltObject(parts, [pieces.hull(*rings), lid], mass=0.18, friction=0.6)
