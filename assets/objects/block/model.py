"""A painted wooden cube of 4 cm with rounded edges."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

BLOCK_COLOURS = {"red": (204, 44, 40), "blue": (36, 92, 196), "green": (40, 150, 70), "yellow": (242, 198, 40)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("block", variant)
    colour = np.array(BLOCK_COLOURS[variant])
    cube = solids.rounded_box((0.04, 0.04, 0.04), 0.003)
    paint_coat = materials.wood(rng, (tuple(colour * 0.86), tuple(np.minimum(colour * 1.05, 255))), 128)
    hull = solids.box((0.04, 0.04, 0.04))
    return BuiltObject([paint(cube, paint_coat, tiled(0.06), roughness=0.5)], [hull], mass=0.045, friction=0.8)
