"""A thick chocolate bar in a foil wrapper with crimped ends, lying along x."""

from __future__ import annotations

import numpy as np

from assets.textures.labels import coded
from assets.textures.product_faces import brand, darker, fading
from vcage.objects.modelling import pieces, prints, solids
from vcage.objects.modelling.mappings import six_sides
from vcage.objects.modelling.parts import BuiltObject, paint

VARIANTS = {
    "milk": ("MILKY", (96, 60, 140), (250, 236, 200)),
    "dark": ("NOIR 70%", (54, 34, 26), (226, 184, 96)),
    "nut": ("NUTTY", (200, 48, 40), (255, 240, 200)),
}
"""Variant → name, ground, ink."""


def build(variant: str) -> BuiltObject:
    name, ground, ink = VARIANTS[variant]
    length, width, height, seam = 0.128, 0.046, 0.024, 0.011
    body = solids.rounded_box((length, width, height), 0.007, steps=4)
    ends = [_crimped_end(side, length / 2 - 0.003, width, height, seam) for side in (-1, 1)]
    wrapper = solids.union(body, *ends)
    picture = fading((896, 288), darker(ground, 1.2), darker(ground, 0.85))
    picture = prints.rectangle(picture, (0, 0.16), (1, 0.19), ink)
    picture = prints.rectangle(picture, (0, 0.81), (1, 0.84), ink)
    picture = brand(picture, name, (0.4, 0.5), 0.34 if len(name) < 6 else 0.27, ink, darker(ground, 0.4))
    picture = _chocolate_pieces(picture, (0.74, 0.5))
    for x in (0.0, 0.93):
        for i in range(8):
            at = x + 0.009 * i
            picture = prints.rectangle(picture, (at, 0), (at + 0.004, 1), darker(ground, 0.6))
    letters = 0.4 if len(name) < 6 else 0.27
    front = brand(prints.canvas(896, 288, ground), name, (0.3, 0.5), letters, ink, darker(ground, 0.4))
    front = coded(front, ("chocolate_bar", variant), (0.7, 0.5))
    sides = {"front": front, "back": front, "top": picture}
    part = paint(wrapper, prints.atlas(sides, ground, (896, 288)), six_sides(), roughness=0.3, crease=30)
    hulls = [body.convex_hull, *ends]
    return BuiltObject([part], hulls, mass=0.1, friction=0.6)


def _crimped_end(side: int, start: float, width: float, height: float, seam: float) -> solids.Solid:
    """The pressed end of a wrapper: thick where it leaves the bar, thin at its edge."""
    middle = height / 2
    inner = [(side * start, y, middle + z) for y in (-0.42 * width, 0.42 * width) for z in (-0.004, 0.004)]
    outer = [(side * (start + seam), y, middle + z) for y in (-0.48 * width, 0.48 * width) for z in (-0.0008, 0.0008)]
    return pieces.hull(inner, outer)


def _chocolate_pieces(picture: np.ndarray, centre: tuple[float, float]) -> np.ndarray:
    """The picture with six squares of chocolate."""
    for i in range(3):
        for j in range(2):
            x, y = centre[0] - 0.09 + 0.075 * i, centre[1] - 0.2 + 0.21 * j
            picture = prints.rectangle(picture, (x, y), (x + 0.07, y + 0.19), (70, 40, 24))
            picture = prints.rectangle(picture, (x + 0.012, y + 0.035), (x + 0.058, y + 0.155), (104, 62, 38))
    return picture
