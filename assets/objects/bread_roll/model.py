"""A round floured roll of 0.066 m with a deep cross cut into its top."""

from __future__ import annotations

import numpy as np

from assets.shapes import lumps
from assets.textures import foods
from vcage.objects.modelling import pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.noise import blend, clouds, over
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("bread_roll", variant)
    middle = 0.0165
    lump = solids.displaced(solids.ellipsoid((0.0325, 0.0325, 0.0245), (0, 0, middle), 40), 0.0007, 0.03, rng)
    lump = solids.above(lump, 0.0)
    crumb = solids.moved(lump, (0, 0, -middle))
    crumb.apply_scale(0.89)
    crumb = solids.moved(crumb, (0, 0, middle))
    cuts = [solids.moved(solids.box((0.05, 0.0055, 0.05), (0, 0, 0.022)), turn=turn) for turn in (45, 135)]
    parts = [
        paint(
            solids.cut(lump, *cuts),
            _roll_crust(rng, seeds=variant == "poppy"),
            lumps.over_dome((0, 0, 0.012)),
            roughness=0.9,
        ),
        paint(crumb, foods.crumb(rng), tiled(0.06), roughness=0.95),
    ]
    return BuiltObject(parts, [pieces.coarse(lump.vertices)], mass=0.055, friction=0.8)


def _roll_crust(rng: np.random.Generator, *, seeds: bool = False, size: int = 320) -> np.ndarray:
    """A round roll spread out from its top: pale gold, browner below, dusted with flour, perhaps with poppy seeds."""
    shape = (size, size)
    inner = foods.from_middle(shape, 0.9)
    picture = blend((176, 112, 52), (224, 178, 112), 0.1 + 1.1 * inner + 0.5 * (clouds(rng, shape, (5, 5)) - 0.5))
    flour = np.clip(clouds(rng, shape, (12, 12)) - 0.36, 0, 1) * np.clip(inner * 2.4 - 0.3, 0, 1)
    picture = over(picture, (252, 246, 234), flour * (1.4 if seeds else 2.6))
    return foods.scattered(rng, picture, [(44, 42, 46)], count=220, length=3, reach=0.66) if seeds else picture
