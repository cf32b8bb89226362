"""A low woven basket, 0.20 × 0.15 m inside."""

from __future__ import annotations

import numpy as np

from assets.shapes.open_box import open_shell
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"natural": (184, 138, 84), "grey": (150, 150, 148)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("basket", variant)
    colour = COLOURS[variant]
    inner, wall, floor, height = (0.20, 0.15), 0.007, 0.006, 0.055
    shell = open_shell(inner, wall, floor, height - 0.004, rounding=0.006)
    outer = np.array(inner) + 2 * wall
    band = solids.prism(solids.rounded_rectangle(outer + 0.004, 0.01), 0.008, height - 0.008)
    band = solids.cut(band, solids.prism(solids.rounded_rectangle(inner, 0.006), 0.1))
    parts = [
        paint(shell, materials.wicker(rng, colour), tiled(0.08), roughness=0.9),
        paint(band, materials.wicker(rng, tuple(int(0.8 * c) for c in colour), weave=16), tiled(0.08), roughness=0.9),
    ]
    hulls = pieces.tray(inner, wall, floor, height)
    return BuiltObject(parts, hulls, mass=0.3, friction=0.7)
