"""A half-litre brick carton of juice with a screw cap on its flat top."""

from __future__ import annotations

import cv2
import numpy as np

from assets.textures.product_faces import brand, darker, ellipse, facts
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import six_sides, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "apple": ("APPLE", (142, 190, 66), (74, 130, 50)),
    "orange": ("ORANGE", (250, 170, 50), (226, 110, 30)),
    "cherry": ("CHERRY", (190, 40, 76), (120, 20, 50)),
}
"""Variant → name, ground, cap colour."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("juice_carton", variant)
    name, ground, cap_colour = VARIANTS[variant]
    size, cell = (0.066, 0.058, 0.14), (320, 640)
    front = prints.canvas(*cell, (250, 250, 244))
    front = ellipse(front, (0.5, 0.0), (0.4, 0.33), ground)
    front = prints.rectangle(front, (0, 0.9), (1, 1), ground)
    front = brand(front, name, (0.5, 0.11), 0.088 if len(name) < 6 else 0.075, (255, 255, 250), darker(ground, 0.7))
    front = brand(front, "JUICE", (0.5, 0.235), 0.06, (255, 255, 250), darker(ground, 0.7))
    front = _fruit(front, variant, (0.5, 0.6), 0.15)
    front = prints.text(front, "500 ml", (0.5, 0.945), 0.04, (255, 255, 250))
    side = facts(cell, ground, ("juice_carton", variant))
    sides = {"front": front, "back": front, "right": side, "left": side}
    body = solids.rounded_box(size, 0.0015, steps=2)
    at = (0, 0.008)
    cap = solids.moved(solids.revolved([(0, 0), (0.0135, 0), (0.0135, 0.011), (0.0125, 0.0125), (0, 0.0125)], 24))
    collar = solids.revolved([(0, 0), (0.017, 0), (0.0165, 0.003), (0, 0.003)], 24)
    parts = [
        paint(body, prints.atlas(sides, ground, cell), six_sides(), roughness=0.45),
        paint(solids.moved(collar, (*at, size[2] - 0.0005)), materials.plastic(rng, (246, 246, 244)), tiled(0.05)),
        paint(
            solids.moved(cap, (*at, size[2] + 0.002)),
            materials.plastic(rng, cap_colour),
            tiled(0.05),
            roughness=0.4,
        ),
    ]
    hulls = [
        solids.box(size),
        pieces.stack([(0.0165, size[2] - 0.001), (0.0165, size[2] + 0.0025)], centre=at),
        pieces.stack([(0.0135, size[2] + 0.002), (0.0135, size[2] + 0.0145)], centre=at),
    ]
    return BuiltObject(parts, hulls, mass=0.5, friction=0.6)


def _fruit(picture: np.ndarray, kind: str, centre: tuple[float, float], radius: float) -> np.ndarray:
    """The picture with an apple, a cut orange or two cherries; ``radius`` as a share of the picture's height."""
    x, y = centre
    across = radius * picture.shape[0] / picture.shape[1]
    if kind == "orange":
        picture = prints.disc(picture, centre, radius, (240, 140, 30))
        picture = prints.disc(picture, centre, 0.88 * radius, (255, 232, 180))
        for i in range(8):
            start = 45 * i + 4
            picture = ellipse(picture, centre, (0.8 * radius, 0.8 * radius), (250, 160, 40), angles=(start, start + 37))
        return picture
    if kind == "apple":
        for side in (-1, 1):
            picture = ellipse(picture, (x + 0.33 * side * across, y), (0.72 * radius, 0.95 * radius), (196, 34, 40))
        picture = ellipse(
            picture, (x - 0.45 * across, y - 0.3 * radius), (0.16 * radius, 0.3 * radius), (240, 130, 120)
        )
        stalk = ((x - 0.05 * across, y - 1.3 * radius), (x + 0.05 * across, y - 0.7 * radius))
        picture = prints.rectangle(picture, *stalk, (90, 60, 30))
        return ellipse(
            picture, (x + 0.42 * across, y - 1.1 * radius), (0.4 * radius, 0.17 * radius), (84, 150, 60), -25
        )
    for side in (-1, 1):
        at = (x + 0.55 * side * across, y + 0.3 * radius)
        top = (x + 0.1 * across, y - 1.1 * radius)
        rows, columns = picture.shape[:2]
        start, end = ((round(p[0] * columns), round(p[1] * rows)) for p in (at, top))
        picture = cv2.line(picture.copy(), start, end, (90, 130, 50), max(1, round(0.1 * radius * rows)), cv2.LINE_AA)
        picture = prints.disc(picture, at, 0.55 * radius, (160, 16, 44))
        shine = (at[0] - 0.18 * across, at[1] - 0.2 * radius)
        picture = prints.disc(picture, shine, 0.12 * radius, (244, 170, 180))
    return ellipse(picture, (x + 0.4 * across, y - 1.05 * radius), (0.35 * radius, 0.16 * radius), (84, 150, 60), -20)
