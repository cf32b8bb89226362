"""A painted wooden ball of 2 cm; its hull has so many faces that it rolls off a slight slope, and rests on one."""

from __future__ import annotations

import numpy as np
import trimesh

from assets.shapes.toy_block import COLOURS
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

RADIUS = 0.01


def build(variant: str) -> BuiltObject:
    rng = variant_rng("ball", variant)
    colour = np.array(COLOURS[variant])
    coat = materials.wood(rng, (tuple(colour * 0.86), tuple(np.minimum(colour * 1.05, 255))), 128)
    ball = solids.ellipsoid((RADIUS, RADIUS, RADIUS), (0, 0, RADIUS), 28)
    hull = pieces.coarse(trimesh.creation.icosphere(subdivisions=4, radius=RADIUS).vertices, directions=110)
    hull.apply_translation((0, 0, RADIUS))
    return BuiltObject([paint(ball, coat, tiled(0.06), roughness=0.5)], [hull], mass=0.004, friction=0.3)
