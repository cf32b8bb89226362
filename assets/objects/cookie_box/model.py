"""A flat-lying carton of cookies, 0.17 m long, with their picture on top."""

from __future__ import annotations

import numpy as np

from assets.textures.labels import coded
from assets.textures.product_faces import brand, darker, fading
from vcage.objects.modelling import prints, solids
from vcage.objects.modelling.mappings import six_sides
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {"cream": ("CREAM DUOS", (38, 74, 150)), "chip": ("CHOCO CHIP", (222, 168, 96))}
"""Variant → name, ground."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("cookie_box", variant)
    dark = variant == "cream"
    name, ground = VARIANTS[variant]
    ink, edge = ((255, 255, 250), (20, 36, 84)) if dark else ((255, 250, 236), (110, 58, 24))
    size, cell = (0.17, 0.06, 0.05), (768, 272)
    top = fading(cell, ground, darker(ground, 0.8))
    for x, y in ((0.82, 0.44), (0.93, 0.72), (0.72, 0.74)):
        top = _cookie(top, rng, (x, y), 0.27, dark=dark)
    first, second = name.split()
    top = brand(top, first, (0.31, 0.32), 0.3, ink, edge)
    top = brand(top, second, (0.31, 0.68), 0.3, ink, edge)
    front = brand(prints.canvas(*cell, ground), name, (0.4, 0.5), 0.28, ink, edge)
    front = _cookie(front, rng, (0.87, 0.5), 0.36, dark=dark)
    # The end is almost square but its cell is long, so the code is drawn wide and flat.
    end = coded(prints.canvas(*cell, ground), ("cookie_box", variant), (0.5, 0.5), module=5, share=0.33)
    sides = {"front": front, "back": front, "top": top, "bottom": top, "left": end, "right": end}
    box = solids.rounded_box(size, 0.0012, steps=2)
    part = paint(box, prints.atlas(sides, ground, cell), six_sides(), roughness=0.45)
    return BuiltObject([part], [solids.box(size)], mass=0.2, friction=0.6)


def _cookie(
    picture: np.ndarray, rng: np.random.Generator, centre: tuple[float, float], radius: float, *, dark: bool
) -> np.ndarray:
    """The picture with a round cookie; dark ones are sandwiches with cream, light ones have chocolate drops."""
    dough = (62, 40, 30) if dark else (206, 150, 84)
    aspect = picture.shape[0] / picture.shape[1]
    picture = prints.disc(picture, (centre[0] + 0.01, centre[1] + 0.03), radius, darker(dough, 0.5))
    picture = prints.disc(picture, centre, radius, dough)
    if dark:
        for share, colour in ((0.82, darker(dough, 1.35)), (0.72, dough), (0.34, darker(dough, 1.35)), (0.26, dough)):
            picture = prints.disc(picture, centre, share * radius, colour)
        for turn in np.linspace(0, 2 * np.pi, 14, endpoint=False):
            at = (centre[0] + 0.54 * radius * aspect * np.cos(turn), centre[1] + 0.54 * radius * np.sin(turn))
            picture = prints.disc(picture, at, 0.07 * radius, darker(dough, 1.5))
        return picture
    picture = prints.disc(picture, centre, 0.86 * radius, darker(dough, 1.1))
    for _ in range(11):
        turn, reach = rng.uniform(0, 2 * np.pi), 0.78 * radius * np.sqrt(rng.random())
        at = (centre[0] + reach * aspect * np.cos(turn), centre[1] + reach * np.sin(turn))
        picture = prints.disc(picture, at, 0.13 * radius, (66, 36, 20))
    return picture
