"""A carrot along x: green stubs to the left, the tip to the right."""

from __future__ import annotations

import numpy as np

from assets.shapes import lumps
from assets.shapes.stalk import stalk
from vcage.objects.modelling import pieces, solids
from vcage.objects.modelling.mappings import around
from vcage.objects.modelling.noise import Colour, blend, clouds, noise, over
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {"orange": ((222, 104, 24), (244, 140, 48)), "purple": ((82, 34, 66), (120, 54, 92))}
"""Variant → low, high."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("carrot", variant)
    low, high = VARIANTS[variant]
    x = np.array([-0.058, -0.056, -0.051, -0.04, -0.01, 0.02, 0.05, 0.072, 0.084, 0.092])
    radius = np.array([0.004, 0.0105, 0.0155, 0.0175, 0.0165, 0.0142, 0.0108, 0.0072, 0.0045, 0.0012])
    shape = lumps.smooth(np.column_stack([radius, x]), 40)
    shape[:, 0] *= 1 + 0.018 * np.sin(shape[:, 1] * 900) * (shape[:, 1] > -0.05)
    body = lumps.lobed(shape, count=24)
    body = solids.moved(body, turn=90, axis=(0, 1, 0))
    body.vertices[:, 2] += np.interp(body.vertices[:, 0], shape[:, 1], shape[:, 0])  # all of it touches the table
    body = solids.above(body, 0.0008)
    skin = _carrot_skin(rng, low, high)
    parts = [paint(body, skin, around(0, (0.0, 0.013)), roughness=0.55)]
    stems = []
    for i, (y, z) in enumerate(((0, 0.5), (-0.6, 0.25), (0.6, 0.2), (-0.3, 0.75), (0.35, 0.8))):
        reach = 0.034 - 0.004 * (i % 3)
        path = [(-0.054, 0.004 * y, 0.0175 + 0.003 * (z - 0.5)), (-0.066, 0.008 * y, 0.0175 + 0.008 * (z - 0.4))]
        path += [(-0.058 - reach, 0.02 * y, 0.0155 + 0.016 * (z - 0.4))]
        stems.append(stalk(path, 0.0024, (84, 142, 56), rng, side=(0, 0, 1)))
    parts += stems
    tuft = pieces.coarse(np.concatenate([stem.vertices for stem in stems]))
    return BuiltObject(parts, [*pieces.slabs(body, 5), tuft], mass=0.09, friction=0.7)


def _carrot_skin(rng: np.random.Generator, low: Colour, high: Colour) -> np.ndarray:
    """Rows run along the carrot: fine rings and short dark creases across it."""
    shape = (384, 128)
    picture = blend(low, high, clouds(rng, shape, (24, 2)))
    return over(picture, np.asarray(low) * 0.62, np.clip((noise(rng, shape, (56, 5)) - 0.83) * 6, 0, 0.6))
