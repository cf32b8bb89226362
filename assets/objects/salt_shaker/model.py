"""A shaker with a metal top; salt is white, pepper dark."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, from_above
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {"salt": ((240, 240, 238), "S"), "pepper": ((58, 52, 50), "P")}
"""Variant → colour, letter."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("salt_shaker", variant)
    colour, letter = VARIANTS[variant]
    body = [(0, 0), (0.019, 0), (0.0205, 0.002), (0.0195, 0.012), (0.0165, 0.036), (0.0158, 0.056), (0, 0.056)]
    cap = np.concatenate(
        [[(0, 0.055), (0.0165, 0.055), (0.0168, 0.064)], solids.arc((0, 0.064), (0.0165, 0.012), 10, 90, 7)]
    )
    ink = (60, 60, 64) if variant == "salt" else (230, 230, 226)
    print_ = materials.plastic(rng, colour, 256)
    for x in (0.25, 0.5, 0.75):
        print_ = prints.text(print_, letter, (x, 0.5), 0.3, ink)
    holes = materials.brushed(rng)
    for i in range(7):
        turn = 2 * np.pi * i / 6
        at = (0.5, 0.5) if i == 6 else (0.5 + 0.2 * np.cos(turn), 0.5 + 0.2 * np.sin(turn))
        holes = prints.disc(holes, at, 0.04, (30, 30, 32))
    parts = [
        paint(solids.revolved(body, 32), print_, around(), roughness=0.25),
        paint(solids.revolved(cap, 32), holes, from_above(), roughness=0.3, metallic=0.4),
    ]
    hulls = [
        pieces.stack([(0.019, 0), (0.0205, 0.002), (0.0195, 0.012), (0.0165, 0.036)]),
        pieces.stack([(0.0165, 0.034), (0.0168, 0.064), (0.0120, 0.0725), (0.004, 0.0758)]),
    ]
    return BuiltObject(parts, hulls, mass=0.12, friction=0.6)
