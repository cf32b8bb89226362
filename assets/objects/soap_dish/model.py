"""A shallow dish with drain slots drawn on its floor."""

from __future__ import annotations

import numpy as np

from assets.shapes import open_box
from assets.textures import packaging
from vcage.objects.modelling import materials, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("soap_dish", variant)
    inner, wall, floor, height = (0.116, 0.08), 0.009, 0.007, 0.028
    body, hulls = open_box.open_box(inner, wall, floor, height, 0.013)
    if variant == "bamboo":
        skin = materials.wood(rng, materials.PINE)
    else:
        skin = materials.speckled(
            rng, {"white": (240, 239, 234), "grey": (140, 146, 152)}[variant], (120, 122, 126), 0.02
        )
    dark = tuple(int(0.55 * c) for c in skin.reshape(-1, 3).mean(axis=0))
    slots = np.tile(skin, (1, 2, 1))[:, : skin.shape[1] * 3 // 2]
    for x in np.linspace(0.12, 0.88, 8):
        slots = packaging.stroke(slots, [(x, 0.2), (x, 0.8)], 0.05, dark)
    grate = solids.prism(solids.rounded_rectangle((inner[0] - 0.004, inner[1] - 0.004), 0.003), 0.0006, floor - 0.0003)
    parts = [
        paint(body, skin, tiled(0.12), roughness=0.35 if variant != "bamboo" else 0.7),
        paint(grate, slots, from_above(), roughness=0.5),
    ]
    return BuiltObject(parts, hulls, mass=0.22, friction=0.6)
