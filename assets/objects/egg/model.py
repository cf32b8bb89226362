"""A hen's egg along x, blunt end to the left, on a tiny flat underside."""

from __future__ import annotations

import numpy as np

from assets.shapes import lumps
from vcage.objects.modelling import pieces
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.noise import Colour, clouds, noise, over, shaded
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"brown": (206, 150, 106), "white": (242, 238, 228), "freckled": (222, 190, 150)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("egg", variant)
    colour = COLOURS[variant]
    angle = np.radians(np.linspace(-86, 86, 30))
    radius = 0.0212 * np.cos(angle) * (1 - 0.12 * np.sin(angle))
    body = lumps.lobed(np.column_stack([radius, 0.0275 * np.sin(angle)]), count=36)
    body = lumps.lying(body, 0.0009)
    shell = _egg_shell(rng, colour, freckled=variant != "white")
    return BuiltObject([paint(body, shell, tiled(0.05), roughness=0.45)], pieces.slabs(body, 2), 0.058, 0.6)


def _egg_shell(rng: np.random.Generator, colour: Colour, freckled: bool) -> np.ndarray:
    """An egg's shell, brown ones with freckles; seamless."""
    shape = (256, 256)
    picture = shaded(np.full((*shape, 3), colour, dtype=np.uint8), 0.95 + 0.07 * clouds(rng, shape))
    if freckled:
        picture = over(picture, np.asarray(colour) * 0.6, np.clip((noise(rng, shape, (50, 50)) - 0.86) * 8, 0, 0.6))
    return picture
