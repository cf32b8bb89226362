"""A slice of layer cake, 0.1 m long: the tip to the left, topped with cream and fruit."""

from __future__ import annotations

import itertools

import numpy as np

from assets.shapes import lumps
from assets.shapes.wedge import bevelled, wedge
from assets.textures import foods
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.noise import Colour, clouds, noise, over, shaded
from vcage.objects.modelling.parts import BuiltObject, Part, paint, variant_rng

CAKE_LAYERS = (0.0, 0.014, 0.0185, 0.0325, 0.037, 0.048)
"""Heights between sponge and filling by turns, from the bottom up, metres."""

CREAM = ((0.001, 0.053), (0.0115, 0.053), (0.0125, 0.057), (0.009, 0.061), (0.0095, 0.0635), (0.004, 0.067), (0, 0.068))
"""Profile (radius, z) of the swirl of cream on a cake, metres."""

CREAM_AT = 0.022
"""Where the swirl is along the slice, metres from the middle of its length."""

VARIANTS = {
    "strawberry": ((238, 200, 130), (252, 246, 236), (246, 168, 178)),
    "chocolate": ((92, 54, 34), (222, 190, 156), (62, 34, 22)),
    "lemon": ((246, 220, 130), (252, 248, 232), (250, 226, 110)),
}
"""Variant → sponge, cream, icing."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("cake_slice", variant)
    sponge, cream, icing = VARIANTS[variant]
    inner, between, outer = wedge(0.095, 17.0), wedge(0.0952, 17.3), wedge(0.0985, 17.15)
    crumb, filling, glaze = _sponge_cake(rng, sponge), materials.plastic(rng, cream), materials.plastic(rng, icing)
    heights = list(itertools.pairwise(CAKE_LAYERS))
    parts = [paint(solids.prism(inner, b - a, a), crumb, tiled(0.05), roughness=0.95) for a, b in heights[::2]]
    parts += [paint(solids.prism(between, b - a, a), filling, tiled(0.05), roughness=0.5) for a, b in heights[1::2]]
    top = bevelled(outer, CAKE_LAYERS[-1] - 0.0005, 0.054)
    back = solids.cut(solids.prism(outer, CAKE_LAYERS[-1]), solids.prism(inner * (1, 1.2), 0.1, -0.01))
    parts += [paint(coat, glaze, tiled(0.06), roughness=0.3) for coat in (top, back)]
    swirl = solids.moved(lumps.lobed(CREAM, 7, 0.16, 42), (CREAM_AT, 0, 0))
    crown = [paint(swirl, filling, tiled(0.04), roughness=0.6), _topping(variant, rng)]
    # The tip and four points of the round back: on a base of many short edges a slice creeps over the table.
    base = outer[[0, 1, 5, 8, 12]]
    slab = pieces.hull(*(np.column_stack([base, np.full(len(base), z)]) for z in (0.0, 0.0535)))
    hulls = [slab, pieces.coarse(np.concatenate([part.vertices for part in crown]))]
    return BuiltObject([*parts, *crown], hulls, mass=0.13, friction=0.8)


def _topping(variant: str, rng: np.random.Generator) -> Part:
    """What lies on the cream: a strawberry, a piece of chocolate, or a slice of lemon."""
    if variant == "strawberry":
        knots = [(0.0005, 0.0), (0.006, 0.0005), (0.0085, 0.004), (0.0075, 0.01), (0.004, 0.0155), (0.0005, 0.0175)]
        berry = solids.moved(lumps.lobed(lumps.smooth(knots, 14), count=20), (CREAM_AT, 0, 0.061))
        return paint(berry, foods.peel(rng, (204, 28, 40)), tiled(0.03), roughness=0.3)
    if variant == "chocolate":
        flake = solids.moved(solids.rounded_box((0.016, 0.004, 0.018), 0.0012), turn=20, axis=(0, 1, 0))
        flake = solids.moved(flake, (CREAM_AT, 0, 0.059))
        return paint(flake, materials.plastic(rng, (58, 32, 22)), tiled(0.03), roughness=0.4)
    rind = [(0, -0.0016), (0.0098, -0.0016), (0.0105, 0), (0.0098, 0.0016), (0, 0.0016)]
    slice_ = solids.moved(solids.revolved(rind, 28), (CREAM_AT, 0, 0.069), turn=90, axis=(1, 0, 0))
    return paint(slice_, materials.plastic(rng, (246, 212, 52)), tiled(0.03), roughness=0.3)


def _sponge_cake(rng: np.random.Generator, colour: Colour, size: int = 192) -> np.ndarray:
    """The cut face of a cake with fine pores."""
    shape = (size, size)
    picture = shaded(np.full((*shape, 3), colour, dtype=np.uint8), 0.86 + 0.24 * clouds(rng, shape, (10, 10)))
    return over(picture, np.asarray(colour) * 0.66, np.clip((noise(rng, shape, (48, 48)) - 0.78) * 4, 0, 0.6))
