"""An open wooden box, 0.26 × 0.20 m inside, lined with a checked cloth."""

from __future__ import annotations

import numpy as np

from assets.shapes.open_box import front_sign, open_shell
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"oak": materials.OAK, "walnut": materials.WALNUT}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("bread_box", variant)
    colours = COLOURS[variant]
    inner, wall, floor, height = (0.26, 0.20), 0.009, 0.008, 0.048
    shell = open_shell(inner, wall, floor, height, rounding=0.003)
    cloth = solids.box((inner[0] - 0.004, inner[1] - 0.004, 0.001), (0, 0, floor - 0.0002))
    parts = [
        paint(shell, materials.wood(rng, colours), tiled(0.14), roughness=0.65),
        paint(cloth, _checked_cloth(rng), tiled(0.08), roughness=0.95),
        front_sign("BREAD", 0.1, 0.026, (0, -inner[1] / 2 - wall, 0.015), colours[1], (62, 36, 20)),
    ]
    hulls = pieces.tray(inner, wall, floor + 0.0008, height)
    return BuiltObject(parts, hulls, mass=0.75, friction=0.6)


def _checked_cloth(rng: np.random.Generator) -> np.ndarray:
    """White linen with crossing red stripes."""
    cloth = materials.felt(rng, (250, 246, 238), 256).astype(np.float32)
    stripe = (np.arange(256) // 32) % 2 == 0
    tint = np.array([0.86, 0.5, 0.46])
    cloth[stripe] *= tint
    cloth[:, stripe] *= tint
    return np.clip(cloth, 0, 255).astype(np.uint8)
