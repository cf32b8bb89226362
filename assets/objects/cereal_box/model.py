"""A small box of breakfast cereals that stands, 0.13 m wide and 0.18 m high."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from assets.textures.product_faces import brand, darker, ellipse, facts, fading
from vcage.objects.modelling import prints, solids
from vcage.objects.modelling.mappings import six_sides
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

CREAM: Colour = (252, 246, 230)

VARIANTS = {
    "honey": ("HONEY", "FLAKES", (244, 190, 44), [(224, 150, 50), (238, 176, 80), (206, 128, 40)]),
    "cocoa": ("COCOA", "RINGS", (112, 62, 36), [(96, 56, 32), (124, 74, 44), (80, 46, 28)]),
    "fruit": ("FRUIT", "RINGS", (58, 152, 206), [(236, 84, 84), (250, 200, 60), (116, 190, 84), (246, 150, 60)]),
}
"""Variant → name, kind, ground, cereals."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("cereal_box", variant)
    name, kind, ground, cereals = VARIANTS[variant]
    size, cell = (0.13, 0.052, 0.18), (384, 532)
    light = tuple(min(255, int(c + 0.4 * (255 - c))) for c in ground)
    front = fading(cell, ground, light)
    front = prints.disc(front, (0.5, 0.74), 0.33, tuple(min(255, int(c + 0.6 * (255 - c))) for c in ground))
    front = _flakes(front, rng, cereals, ring=kind == "RINGS")
    edge = darker(ground, 0.35)
    front = brand(front, name, (0.5, 0.14), 0.125, CREAM, edge)
    front = brand(front, kind, (0.5, 0.31), 0.125, CREAM, edge)
    side = facts(cell, ground, ("cereal_box", variant), module=3, share=0.3)
    top = brand(prints.canvas(384, 154, ground), f"{name} {kind}", (0.5, 0.5), 0.26, CREAM, edge)
    sides = {"front": front, "back": front, "right": side, "left": side, "top": top}
    box = solids.rounded_box(size, 0.0012, steps=2)
    part = paint(box, prints.atlas(sides, ground, cell), six_sides(), roughness=0.5)
    return BuiltObject([part], [solids.box(size)], mass=0.22, friction=0.6)


def _flakes(picture: np.ndarray, rng: np.random.Generator, colours: Sequence[Colour], ring: bool) -> np.ndarray:
    """A bowl of cereals with milk in the lower half of the picture; ``ring`` for rings instead of flakes."""
    picture = ellipse(picture, (0.5, 0.78), (0.33, 0.24), (56, 92, 160), angles=(0, 180))
    picture = ellipse(picture, (0.5, 0.78), (0.33, 0.1), (240, 244, 250))
    picture = ellipse(picture, (0.5, 0.78), (0.3, 0.08), (250, 250, 244))
    aspect = picture.shape[0] / picture.shape[1]
    for i in range(46):
        turn, reach = rng.uniform(0, 2 * np.pi), np.sqrt(rng.random())
        lift = 0.09 * (1 - reach) * rng.random()
        centre = (0.5 + 0.26 * aspect * reach * np.cos(turn), 0.77 + 0.065 * reach * np.sin(turn) - lift)
        colour = colours[i % len(colours)]
        picture = ellipse(picture, (centre[0], centre[1] + 0.005), (0.034, 0.022), darker(colour), rng.uniform(0, 180))
        picture = ellipse(picture, centre, (0.032, 0.02), colour, rng.uniform(0, 180))
        if ring:
            picture = ellipse(picture, centre, (0.011, 0.007), darker(colour, 0.5))
    return picture
