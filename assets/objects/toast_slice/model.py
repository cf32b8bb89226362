"""A thick slice of a small tin loaf, lying on its cut face."""

from __future__ import annotations

import numpy as np

from assets.textures import foods
from vcage.objects.modelling import pieces, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("toast_slice", variant)
    outline = np.concatenate(
        [
            [(-0.029, -0.034), (0.029, -0.034), (0.030, -0.030), (0.030, 0.010)],
            solids.arc((0.018, 0.020), 0.0145, -20, 80, 6),
            solids.arc((-0.018, 0.020), 0.0145, 100, 200, 6),
            [(-0.030, 0.010), (-0.030, -0.030)],
        ]
    )
    height = 0.018
    crumb = solids.prism(outline * 0.93, height + 0.0008, -0.0004)
    crust = solids.prism(outline, height)
    parts = [
        paint(crust, foods.plain_crust(rng), tiled(0.06), roughness=0.85),
        paint(crumb, foods.crumb(rng, toasted=variant == "toasted"), from_above(), roughness=0.95),
    ]
    top = [(x, y, z) for x, y in outline for z in (-0.0004, height + 0.0004)]
    return BuiltObject(parts, [pieces.hull(top)], mass=0.03, friction=0.8)
