"""A paper cup without a lid, wider at the top."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"white": (242, 240, 236), "teal": (48, 140, 146)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("cup", variant)
    colour = COLOURS[variant]
    height, wall, floor = 0.085, 0.002, 0.005
    low, high = 0.026, 0.0345
    profile = [(0, 0), (low, 0), (high - 0.0012, height - 0.005), (high, height - 0.003), (high, height - 0.001)]
    profile += [(high - 0.001, height), (high - wall - 0.001, height), (low - wall + 0.0005, floor), (0, floor)]
    print_ = materials.plastic(rng, colour, 256)
    ink = (52, 120, 126) if variant == "white" else (236, 240, 236)
    wave = (np.sin(np.arange(256) * 2 * np.pi * 4 / 256) * 10 + 120).astype(int)
    for column, row in enumerate(wave):
        print_[row : row + 26, column] = ink
        print_[row + 36 : row + 44, column] = ink
    hulls = [pieces.stack([(low, 0), (low + 0.0005, floor)])]
    hulls += pieces.ring([(low - wall, floor), (low, floor), (high, height), (high - wall - 0.001, height)])
    outside, inside = solids.split_by_facing(solids.revolved(profile, 40))
    parts = [
        paint(outside, print_, around(), roughness=0.8),
        paint(inside, materials.plastic(rng, (240, 238, 232)), tiled(0.1), roughness=0.8),
    ]
    return BuiltObject(parts, hulls, mass=0.04, friction=0.7)
