"""A shiny brown ring of bread with a wide hole, perhaps with sesame seeds."""

from __future__ import annotations

import numpy as np

from assets.shapes import lumps
from assets.shapes.ring_pastry import ring_pastry
from assets.textures.foods import coordinates, strokes
from vcage.objects.modelling.noise import blend, clouds, noise, over
from vcage.objects.modelling.parts import BuiltObject, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("bagel", variant)
    outer, tube = 0.0345, (0.0105, 0.0125)
    crust = _bagel_crust(rng, seeds=variant == "sesame")
    mapping = lumps.over_ring(outer - tube[0], 0.85 * tube[1])
    return ring_pastry([(crust, 0.32, 0.0)], rng, outer, tube, mapping)


def _bagel_crust(rng: np.random.Generator, seeds: bool, size: int = 576) -> np.ndarray:
    """A bagel's skin spread out as a disc: the top of the ring half-way out, its underside in the middle and outside.

    Chestnut brown, paler below; sesame seeds lie thick on the top.
    """
    shape = (size, size)
    away = np.hypot(*coordinates(shape))
    top = np.clip(1 - ((away - 0.47) / 0.4) ** 2, 0, 1)
    picture = blend((218, 162, 94), (142, 76, 32), 0.05 + 0.95 * top + 0.5 * (clouds(rng, shape, (5, 5)) - 0.5))
    blisters = noise(rng, shape, (40, 40)) > 0.9
    picture = over(picture, (214, 160, 98), blisters * top * 0.5)
    if not seeds:
        return picture
    turn, far = rng.uniform(0, 2 * np.pi, 480), rng.normal(0.47, 0.11, 480).clip(0.26, 0.72)
    places = np.column_stack([far * np.cos(turn), far * np.sin(turn)])
    return strokes(rng, picture, [(250, 236, 200), (238, 216, 166)], places, length=5)
