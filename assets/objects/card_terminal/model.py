"""A payment terminal, 0.064 m wide, that rises to the back: keys in front, screen behind, a slip at the end."""

from __future__ import annotations

import cv2
import numpy as np

from assets.shapes.sloped_plate import sloped_plate
from assets.textures import till_faces
from vcage.objects.modelling import materials, prints, solids
from vcage.objects.modelling.mappings import from_above, from_front, tiled
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {"black": ((50, 52, 58), (78, 82, 90)), "white": ((234, 234, 230), (196, 198, 202))}
"""Variant → colour, key colour."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("card_terminal", variant)
    colour, key_colour = VARIANTS[variant]
    width, front, back = 0.064, -0.08, 0.08
    low, high = (front + 0.002, 0.024), (back - 0.02, 0.052)
    outline = [(front + 0.002, 0), (back - 0.002, 0), (back, 0.004), (back, 0.036), (back - 0.006, 0.048), high]
    outline += [low, (front, 0.02), (front, 0.003)]
    body = solids.moved(solids.prism(outline, width, -width / 2), turn=120, axis=(1, 1, 1))  # y, z, x → x, y, z
    parts = [
        paint(body, materials.plastic(rng, colour), tiled(0.1), roughness=0.45, crease=25),
        paint(
            sloped_plate((0.054, 0.048, 0.0016), low, high, 0, 0.76),
            _payment_screen(),
            from_above(),
            roughness=0.15,
        ),
    ]
    for i, key in enumerate("123456789*0#XCO"):
        row, column = divmod(i, 3)
        ground = {"X": (206, 50, 44), "C": (236, 186, 40), "O": (60, 160, 80)}.get(key, key_colour)
        light = sum(ground) < 420
        cap = prints.text(prints.canvas(64, 44, ground), key, (0.5, 0.5), 0.62, (250,) * 3 if light else (40, 42, 46))
        share = 0.5 - 0.095 * row
        button = sloped_plate((0.0145, 0.0095, 0.0036), low, high, -0.0175 + 0.0175 * column, share, radius=0.0014)
        parts.append(paint(button, cap, from_above(), roughness=0.5))
    slot = solids.box((0.046, 0.004, 0.004), (0, front - 0.0015, 0.011))
    card = solids.box((0.044, 0.0016, 0.016), (0, back - 0.0115, 0.046))
    parts += [
        paint(slot, materials.plastic(rng, (24, 24, 26)), tiled(0.05), roughness=0.5),
        paint(card, till_faces.receipt((256, 96), rows=2), from_front(), roughness=0.9),
    ]
    return BuiltObject(parts, [body.convex_hull, slot, card], mass=0.3, friction=0.7)


def _waves(picture: np.ndarray, centre: tuple[float, float], height: float, colour: Colour) -> np.ndarray:
    """The picture with the sign for cards that pay without contact: four arcs, each larger than the last."""
    rows, columns = picture.shape[:2]
    out = picture.copy()
    at = (round(centre[0] * columns - 0.5 * height * rows), round(centre[1] * rows))
    for i in range(4):
        radius = round((0.22 + 0.26 * i) * height * rows)
        thickness = max(2, round(0.09 * height * rows))
        cv2.ellipse(out, at, (radius, radius), 0, -38, 38, tuple(int(c) for c in colour), thickness, cv2.LINE_AA)
    return out


def _payment_screen() -> np.ndarray:
    """The screen of a card terminal that waits for a card."""
    picture = prints.canvas(324, 288, (24, 62, 110))
    picture = prints.rectangle(picture, (0, 0), (1, 0.17), (240, 244, 248))
    picture = prints.text(picture, "TOTAL", (0.5, 0.085), 0.11, (24, 62, 110))
    picture = prints.text(picture, "12.50", (0.5, 0.37), 0.25, (255, 255, 255))
    picture = prints.text(picture, "TAP OR INSERT CARD", (0.5, 0.6), 0.075, (206, 222, 240))
    return _waves(picture, (0.5, 0.81), 0.22, (120, 220, 150))
