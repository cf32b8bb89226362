"""A doughnut with icing and sprinkles."""

from __future__ import annotations

import numpy as np

from assets.shapes.ring_pastry import ring_pastry
from assets.textures import foods
from vcage.objects.modelling.noise import Colour, clouds, shaded
from vcage.objects.modelling.parts import BuiltObject, variant_rng

ICINGS = {"pink": (240, 140, 170), "chocolate": (78, 44, 28)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("donut", variant)
    icing = ICINGS[variant]
    dough = foods.plain_crust(rng, (214, 158, 92))
    return ring_pastry(
        [(dough, 0.8, 0.0), (_sprinkles(rng, icing), 0.25, 0.0165)], rng, outer=0.032, tube=(0.0118, 0.0125)
    )


def _sprinkles(rng: np.random.Generator, icing: Colour, size: int = 256) -> np.ndarray:
    """Icing with coloured sprinkles."""
    ground = shaded(np.full((size, size, 3), icing, dtype=np.uint8), 0.95 + 0.08 * clouds(rng, (size, size)))
    colours = [(250, 250, 250), (250, 214, 60), (90, 180, 230), (120, 200, 110), (230, 60, 90)]
    return foods.scattered(rng, ground, colours, count=170, length=10, reach=1.0)
