"""A small carton with a gabled top."""

from __future__ import annotations

import numpy as np

from assets.textures.labels import coded
from vcage.objects.modelling import materials, prints, solids
from vcage.objects.modelling.mappings import six_sides, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

GROUNDS = {"whole": (44, 98, 180), "oat": (216, 190, 142)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("milk_carton", variant)
    ground = GROUNDS[variant]
    side, wall, gable = 0.06, 0.1, 0.124
    body = solids.box((side, side, wall))
    outline = np.array([(-side / 2, 0), (side / 2, 0), (0.0012, gable - wall), (-0.0012, gable - wall)])
    roof = solids.moved(solids.prism(outline, side, -side / 2), turn=90, axis=(1, 0, 0))
    roof = solids.moved(roof, (0, 0, wall))
    fin = solids.box((0.0024, side, 0.014), (0, 0, gable - 0.001))
    words = "MILK" if variant == "whole" else "OAT"
    face = prints.canvas(384, 640, (246, 246, 242))
    face = prints.rectangle(face, (0, 0.52), (1, 1), ground)
    face = prints.text(face, words, (0.5, 0.3), 0.16, tuple(int(0.6 * c) for c in ground))
    face = prints.disc(face, (0.5, 0.74), 0.11, (250, 250, 246))
    sides = dict.fromkeys(("front", "back", "left"), face)
    sides["right"] = coded(face, ("milk_carton", variant), (0.5, 0.72))
    carton = prints.atlas(sides, (246, 246, 242), (384, 640))
    parts = [
        paint(body, carton, six_sides(), roughness=0.6),
        paint(roof, materials.plastic(rng, (244, 244, 240)), tiled(0.1), roughness=0.6),
        paint(fin, materials.plastic(rng, ground), tiled(0.1), roughness=0.6),
    ]
    return BuiltObject(parts, [body, roof.convex_hull, fin], mass=0.3, friction=0.6)
