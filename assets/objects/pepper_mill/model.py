"""A turned pepper mill, 0.165 m high, with a steel knob."""

from __future__ import annotations

import numpy as np

from assets.shapes import lumps
from assets.textures import kitchen
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

ASH = ((208, 180, 140), (236, 214, 180))

COLOURS = {"walnut": materials.WALNUT, "ash": ASH, "black": ((30, 28, 28), (58, 54, 52))}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("pepper_mill", variant)
    knots = [(0.027, 0), (0.0275, 0.006), (0.0245, 0.02), (0.0175, 0.05), (0.016, 0.065), (0.0205, 0.088)]
    knots += [(0.0225, 0.1), (0.0195, 0.11), (0.0165, 0.114)]
    body = lumps.smooth(knots, 26)
    head = np.concatenate([[(0.0165, 0.1155)], solids.arc((0, 0.135), (0.0235, 0.022), -50, 78, 16)])
    knob = np.concatenate([[(0, 0.154), (0.005, 0.154), (0.0045, 0.157)], solids.arc((0, 0.1605), 0.0055, -30, 90, 7)])
    ring = [(0.01, 0.1135), (0.0172, 0.1135), (0.0172, 0.1162), (0.01, 0.1162)]
    colours = COLOURS[variant]
    wood = materials.wood(rng, colours)
    metal = kitchen.steel(rng)
    parts = []
    for outline in (body, head):
        closed = np.concatenate([[(0, outline[0, 1])], outline, [(0, outline[-1, 1])]])
        parts.append(paint(solids.revolved(closed, 40), wood, tiled(0.1, along=2), roughness=0.4))
    parts += [paint(solids.revolved(p, 32), metal, tiled(0.05), roughness=0.3, metallic=0.5) for p in (ring, knob)]
    hulls = [pieces.stack([tuple(p) for p in rows]) for rows in (body[:13:3], body[12:19:2], body[18::2], head[::3])]
    hulls.append(pieces.stack([(0.0045, 0.154), (0.0055, 0.1605), (0.003, 0.1655)], 8))
    return BuiltObject(parts, hulls, mass=0.3, friction=0.6)
