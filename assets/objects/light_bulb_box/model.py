"""The carton of one light bulb, standing upright."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import prints, solids
from vcage.objects.modelling.mappings import six_sides
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, paint

VARIANTS = {
    "warm": ((36, 50, 92), (252, 212, 90), "WARM WHITE"),
    "daylight": ((40, 130, 190), (246, 250, 252), "DAYLIGHT"),
}
"""Variant → ground, glow, words."""


def build(variant: str) -> BuiltObject:
    ground, glow, words = VARIANTS[variant]
    size = (0.06, 0.06, 0.108)
    face = _light_bulb(prints.canvas(224, 400, ground), (0.5, 0.38), 0.44, glow)
    face = packaging.fitted(face, "BRIGHTON", (0.5, 0.08), (0.8, 0.06), (252, 252, 250))
    face = packaging.fitted(face, words, (0.5, 0.72), (0.8, 0.05), glow)
    face = packaging.fitted(face, "LED 9 W", (0.5, 0.82), (0.6, 0.07), (252, 252, 250))
    face = packaging.fitted(face, "= 60 W", (0.5, 0.92), (0.4, 0.05), (252, 252, 250))
    top = _light_bulb(prints.canvas(224, 224, ground), (0.5, 0.54), 0.66, glow)
    sides = dict.fromkeys(("front", "back", "left", "right"), face) | {"top": top}
    box = solids.rounded_box(size, 0.0012, steps=2)
    part = paint(box, prints.atlas(sides, ground, (224, 400)), six_sides(), roughness=0.6)
    return BuiltObject([part], [solids.box(size)], mass=0.09, friction=0.6)


def _light_bulb(picture: np.ndarray, centre: tuple[float, float], height: float, glow: Colour) -> np.ndarray:
    """The picture with a drawn light bulb and rays; ``height`` is a share of the picture's."""
    rows, columns = picture.shape[:2]
    wide = height * rows / columns
    x, y = centre
    for turn in np.radians(np.arange(-150, -29, 30)):
        ray = np.array([np.cos(turn) * wide, np.sin(turn) * height])
        start, end = np.array([x, y - 0.12 * height]) + 0.42 * ray, np.array([x, y - 0.12 * height]) + 0.54 * ray
        picture = packaging.stroke(picture, [tuple(start), tuple(end)], 0.035 * height, glow)
    picture = prints.disc(picture, (x, y - 0.12 * height), 0.33 * height, glow)
    neck = [(-0.22, 0.1), (0.22, 0.1), (0.13, 0.32), (-0.13, 0.32)]
    picture = packaging.polygon(picture, [(x + a * wide, y + b * height) for a, b in neck], glow)
    for step in range(3):
        top = y + (0.33 + 0.06 * step) * height
        picture = prints.rectangle(
            picture, (x - 0.13 * wide, top), (x + 0.13 * wide, top + 0.04 * height), (96, 98, 104)
        )
    return picture
