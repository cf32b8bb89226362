"""A triangular scale ruler, as draughtsmen use: lies on a face along x."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, prints, solids
from vcage.objects.modelling.mappings import from_above
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

GROUNDS = {"white": (240, 238, 230), "yellow": (240, 208, 84)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("ruler", variant)
    width, height, length = 0.03, 0.026, 0.17
    outline = np.array([(-width / 2, 0), (width / 2, 0), (0.0012, height), (-0.0012, height)])
    bar = solids.moved(solids.prism(outline, length, -length / 2), turn=90, axis=(1, 0, 0))
    bar = solids.moved(bar, turn=90)
    ground = GROUNDS[variant]
    scale = materials.plastic(rng, ground, 128).repeat(8, axis=1)
    for side in (0.0, 0.5):
        for i in range(1, 86):
            reach = 0.20 if i % 10 == 0 else 0.15 if i % 5 == 0 else 0.09
            edge = side if side == 0 else 1 - reach
            scale = prints.rectangle(scale, (i / 86 - 0.0012, edge), (i / 86 + 0.0012, edge + reach), (30, 30, 34))
    for i in range(1, 9):
        for y in (0.28, 0.72):
            scale = prints.text(scale, str(2 * i), (2 * i / 17.2, y), 0.13, (30, 30, 34))
    return BuiltObject([paint(bar, scale, from_above(), roughness=0.4)], [bar.convex_hull], mass=0.05, friction=0.6)
