"""A pocket calculator with a raised display."""

from __future__ import annotations

from vcage.objects.modelling import materials, prints, solids
from vcage.objects.modelling.mappings import from_above
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"grey": (70, 74, 82), "white": (226, 226, 222)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("calculator", variant)
    colour = COLOURS[variant]
    body = solids.rounded_box((0.064, 0.105, 0.017), 0.004)
    face = materials.plastic(rng, colour, 256)
    face = prints.rectangle(face, (0.1, 0.07), (0.9, 0.27), (28, 30, 34))
    face = prints.rectangle(face, (0.13, 0.09), (0.87, 0.25), (168, 186, 158))
    face = prints.text(face, "2026", (0.7, 0.17), 0.11, (40, 48, 40))
    keys = []
    for i, key in enumerate("789/456x123-0.=+"):
        x, y = -0.0225 + 0.015 * (i % 4), 0.018 - 0.0175 * (i // 4)
        ground = (226, 120, 40) if key in "/x-+=" else (236, 236, 232) if variant == "grey" else (90, 94, 100)
        ink = (250, 250, 250) if key in "/x-+=" or variant == "white" else (30, 30, 34)
        cap = prints.text(prints.canvas(48, 48, ground), key, (0.5, 0.5), 0.7, ink)
        keys.append(
            paint(solids.rounded_box((0.011, 0.012, 0.004), 0.0012, (x, y, 0.0155)), cap, from_above(), roughness=0.5)
        )
    hulls = [body.convex_hull, solids.box((0.058, 0.068, 0.0185), (0, -0.0085, 0.001))]
    return BuiltObject([paint(body, face, from_above(), roughness=0.5), *keys], hulls, mass=0.09, friction=0.6)
