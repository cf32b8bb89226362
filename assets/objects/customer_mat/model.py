"""A rubber counter mat, 0.36 × 0.24 m, that marks the customer's side."""

from __future__ import annotations

import cv2
import numpy as np

from vcage.objects.modelling import prints, solids
from vcage.objects.modelling.mappings import from_above
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, paint

VARIANTS = {
    "black": ((42, 44, 48), (240, 240, 236)),
    "blue": ((34, 74, 130), (250, 250, 246)),
    "green": ((38, 100, 70), (250, 244, 214)),
}
"""Variant → ground, ink."""


def build(variant: str) -> BuiltObject:
    ground, ink = VARIANTS[variant]
    size, height = (0.36, 0.24), 0.004
    mat = solids.prism(solids.rounded_rectangle(size, 0.014), height)
    part = paint(mat, _customer_floor(ground, ink), from_above(), roughness=0.85)
    return BuiltObject([part], [mat.convex_hull], mass=0.35, friction=0.9)


def _customer_floor(ground: Colour, ink: Colour) -> np.ndarray:
    """The face of a counter mat for the customer's side: the word in a double frame, and lines of studs."""
    picture = prints.canvas(1080, 720, ground)
    light = tuple(min(255, c + 14) for c in ground)
    for row in range(20):
        for column in range(30):
            picture = prints.disc(picture, ((column + 0.5) / 30, (row + 0.5) / 20), 0.008, light)
    for inset, thickness in ((0.035, 0.014), (0.065, 0.005)):
        picture = _frame(picture, inset, thickness, ink)
    picture = prints.rectangle(picture, (0.14, 0.36), (0.86, 0.64), ground)
    return prints.text(picture, "CUSTOMER", (0.5, 0.5), 0.19, ink)


def _frame(picture: np.ndarray, inset: float, thickness: float, colour: Colour) -> np.ndarray:
    """The picture with a rectangle of lines; inset and thickness as shares of its height."""
    rows, columns = picture.shape[:2]
    out = picture.copy()
    edge, wide = round(inset * rows), max(1, round(thickness * rows))
    corners = ((edge, edge), (columns - edge, rows - edge))
    return cv2.rectangle(out, *corners, tuple(int(c) for c in colour), wide)
