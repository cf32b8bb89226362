"""Eight upright batteries of size AA in a printed sleeve."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import lofts, materials, prints, solids
from vcage.objects.modelling.mappings import six_sides, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "copper": ((196, 118, 58), (30, 30, 34), "VOLTRA"),
    "green": ((84, 170, 84), (246, 246, 244), "ECOCELL"),
}
"""Variant → top, ground, words."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("battery_pack", variant)
    top, ground, words = VARIANTS[variant]
    radius, height = 0.00725, 0.0485
    cells, nipples = [], []
    for column in range(4):
        for row in range(2):
            at = ((column - 1.5) * 2 * radius, (row - 0.5) * 2 * radius, 0)
            profile = [(0, 0), (radius - 0.0006, 0), (radius, 0.0006), (radius, height - 0.0008)]
            cells.append(solids.moved(solids.revolved([*profile, (radius - 0.001, height), (0, height)], 20), at))
            nub = [(0, height - 0.0004), (0.0027, height - 0.0004), (0.0027, height + 0.0015), (0, height + 0.0015)]
            nipples.append(solids.moved(solids.revolved(nub, 14), at))
    size = (8 * radius + 0.0008, 4 * radius + 0.0008)
    sleeve = solids.prism(solids.rounded_rectangle(size, radius * 0.95, 5), 0.03, 0.004)
    ink = top if variant == "copper" else (34, 110, 50)
    front = packaging.label((384, 192), ground, [(words, 0.34, 0.8, 0.28, ink)], [(0.84, 1.0, top)], (0.5,))
    front = packaging.fitted(front, "AA  x8  alkaline", (0.5, 0.66), (0.6, 0.15), ink)
    side = packaging.label((192, 192), ground, [("AA", 0.4, 0.6, 0.3, ink)], [(0.84, 1.0, top)], (0.5,))
    picture = prints.atlas({"front": front, "back": front, "left": side, "right": side}, ground, (384, 192))
    parts = [
        paint(solids.union(*cells), materials.brushed(rng, top), tiled(0.05), roughness=0.3, metallic=0.4),
        paint(solids.union(*nipples), materials.brushed(rng), tiled(0.05), roughness=0.25, metallic=0.5),
        paint(sleeve, picture, six_sides(), roughness=0.4),
    ]
    outline = solids.rounded_rectangle(size, radius * 0.95, 3)
    hulls = [lofts.levelled_hull(np.repeat(outline, 2, axis=0), [(0, 0.985), (0.004, 1.0), (height + 0.0008, 0.985)])]
    return BuiltObject(parts, hulls, mass=0.19, friction=0.6)
