"""An open cup for toothbrushes, a brush drawn on it."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "white": ((242, 241, 236), (52, 128, 150)),
    "aqua": ((122, 190, 190), (248, 248, 244)),
    "stone": ((126, 124, 122), (240, 238, 232)),
}
"""Variant → ground, ink."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("toothbrush_holder", variant)
    ground, ink = VARIANTS[variant]
    radius, height, wall, floor = 0.0345, 0.092, 0.0032, 0.006
    profile = [(0, 0), (radius - 0.003, 0), (radius, 0.003), (radius, height - 0.001), (radius - 0.001, height)]
    profile += [(radius - wall, height - 0.0005), (radius - wall, floor), (0, floor)]
    outside, inside = solids.split_by_facing(solids.revolved(profile, 44))
    glaze = materials.speckled(rng, ground, tuple(int(0.7 * c) for c in ground), 0.02 if variant != "stone" else 0.16)
    picture = np.tile(glaze, (1, 2, 1))[:, :512]
    picture = prints.rectangle(picture, (0, 0.06), (1, 0.08), ink)
    for x in (0.02, 0.27, 0.52, 0.77):
        for shift, lean in ((0.0, 0.03), (0.09, -0.03)):
            foot, neck, tip = (x + shift, 0.8), (x + shift + lean * 0.7, 0.36), (x + shift + lean, 0.22)
            picture = packaging.stroke(picture, [foot, neck], 0.05, ink)
            picture = packaging.stroke(picture, [neck, tip], 0.028, ink)
            side = 0.016 if lean > 0 else -0.016
            bristle = [(tip[0] + side, tip[1]), (neck[0] + side, neck[1] - 0.03)]
            picture = packaging.stroke(picture, bristle, 0.06, (226, 120, 90))
    parts = [
        paint(outside, picture, around(), roughness=0.3),
        paint(inside, glaze, tiled(0.1), roughness=0.3),
    ]
    hulls = [pieces.stack([(radius - 0.002, 0), (radius, 0.003), (radius, floor)])]
    hulls += pieces.ring([(radius - wall, floor), (radius, floor), (radius, height), (radius - wall, height)])
    return BuiltObject(parts, hulls, mass=0.22, friction=0.6)
