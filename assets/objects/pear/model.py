"""A pear of 0.066 m across that stands upright, with its stem."""

from __future__ import annotations

import numpy as np

from assets.shapes import lumps
from assets.shapes.stalk import stalk
from vcage.objects.modelling import pieces, solids
from vcage.objects.modelling.mappings import around
from vcage.objects.modelling.noise import Colour, blend, clouds, noise, over
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "green": ((150, 168, 56), (190, 200, 92), (186, 150, 60)),
    "yellow": ((222, 184, 66), (240, 212, 106), (214, 120, 54)),
    "red": ((150, 44, 38), (188, 82, 52), (206, 150, 70)),
}
"""Variant → low, high, blush."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("pear", variant)
    low, high, blush = VARIANTS[variant]
    knots = [
        (0.004, 0.002),
        (0.013, 0),
        (0.024, 0.006),
        (0.032, 0.021),
        (0.0325, 0.032),
        (0.028, 0.048),
        (0.0205, 0.062),
    ]
    knots += [(0.0165, 0.074), (0.013, 0.082), (0.0065, 0.0865), (0.0025, 0.0855)]
    body = solids.displaced(lumps.lobed(lumps.smooth(knots, 32), 5, 0.006, 36), 0.0004, 0.03, rng)
    body = solids.above(body, float(body.bounds[0, 2]) + 0.0004)
    parts = [
        paint(body, _pear_skin(rng, low, high, blush), around(), roughness=0.45),
        stalk([(0, 0, 0.083), (0.0006, 0, 0.088), (0.0025, 0, 0.093), (0.0055, 0, 0.0965)], 0.0017, (88, 62, 36), rng),
    ]
    stem = pieces.coarse(parts[1].vertices, 24)
    return BuiltObject(parts, [*pieces.slabs(body, 4, axis=2), stem], mass=0.17, friction=0.7)


def _pear_skin(rng: np.random.Generator, low: Colour, high: Colour, blush: Colour) -> np.ndarray:
    """Pear: a blush on one side and small brown freckles."""
    shape = (256, 256)
    picture = blend(low, high, clouds(rng, shape, (4, 4)))
    side = 0.5 + 0.5 * np.cos(np.linspace(-np.pi, np.pi, shape[1]) - 0.9)[None]
    picture = over(picture, blush, np.clip(side * clouds(rng, shape, (3, 4)) * 1.5 - 0.35, 0, 0.8))
    return over(picture, (122, 92, 40), (noise(rng, shape, (64, 80)) > 0.93) * 0.6)
