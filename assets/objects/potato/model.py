"""A potato of 0.085 m, lying along x."""

from __future__ import annotations

import numpy as np

from assets.shapes import lumps
from vcage.objects.modelling import pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.noise import Colour, blend, clouds, noise, over, shaded
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "brown": ((160, 118, 68), (206, 166, 108)),
    "red": ((142, 66, 58), (180, 98, 82)),
    "yellow": ((196, 156, 82), (232, 198, 126)),
}
"""Variant → low, high."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("potato", variant)
    low, high = VARIANTS[variant]
    knots = [(0.002, -0.043), (0.013, -0.041), (0.025, -0.031), (0.029, -0.013), (0.0285, 0.008), (0.026, 0.024)]
    knots += [(0.02, 0.035), (0.011, 0.0405), (0.002, 0.042)]
    body = lumps.lobed(lumps.smooth(knots, 26), count=32)
    body.apply_scale((0.86, 1.0, 1.0))
    body = lumps.lying(solids.displaced(body, 0.0018, 0.05, rng), 0.002)
    part = paint(body, _potato_skin(rng, low, high), tiled(0.08), roughness=0.9)
    return BuiltObject([part], pieces.slabs(body, 3), mass=0.14, friction=0.8)


def _potato_skin(rng: np.random.Generator, low: Colour, high: Colour) -> np.ndarray:
    """Earthy skin with darker eyes; seamless."""
    shape = (256, 256)
    picture = blend(low, high, clouds(rng, shape, (5, 5)))
    picture = over(picture, np.asarray(low) * 0.6, np.clip((noise(rng, shape, (9, 6)) - 0.84) * 6, 0, 0.7))
    picture = over(picture, np.asarray(low) * 0.7, (noise(rng, shape, (80, 60)) > 0.92) * 0.5)
    return shaded(picture, 0.9 + 0.16 * noise(rng, shape, (90, 90)))
