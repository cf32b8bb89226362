"""A mobile phone in a thick rubber bumper, lying on its back, screen on."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageDraw

from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.noise import Colour, blend
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "black": ((42, 43, 47), ((28, 42, 92), (150, 74, 140))),
    "blue": ((40, 98, 176), ((8, 62, 78), (70, 172, 160))),
    "red": ((194, 46, 44), ((70, 24, 60), (236, 132, 70))),
}
"""Variant → bumper, wallpaper."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("mobile_phone", variant)
    bumper, wallpaper = VARIANTS[variant]
    width, length, height = 0.067, 0.139, 0.0175
    case = solids.prism(solids.rounded_rectangle((width, length), 0.011), height - 0.002, 0.001)
    chamfer = [
        solids.prism(solids.rounded_rectangle((width - 0.002, length - 0.002), 0.010), 0.0012, z)
        for z in (0.0, height - 0.0012)
    ]
    well = solids.prism(solids.rounded_rectangle((width - 0.007, length - 0.007), 0.0075), 0.01, height - 0.0014)
    glass = solids.prism(solids.rounded_rectangle((width - 0.007, length - 0.007), 0.0075), 0.002, height - 0.0026)
    ribs = [
        solids.box((0.0008, 0.0016, 0.010), (side * (width / 2 + 0.0001), y, 0.0035))
        for side in (-1, 1)
        for y in np.linspace(-0.018, 0.018, 7)
    ]
    keys = [
        solids.rounded_box((0.0016, size, 0.005), 0.0007, (width / 2, y, 0.0065), steps=1)
        for y, size in ((0.042, 0.012), (0.028, 0.008))
    ]
    rubber = materials.plastic(rng, bumper)
    parts = [
        paint(solids.cut(solids.union(case, *chamfer), well), rubber, tiled(0.05), roughness=0.85),
        paint(glass, _phone_screen((320, 704), wallpaper), from_above(), roughness=0.15),
        paint(solids.union(*ribs, *keys), materials.plastic(rng, [int(c * 0.7) for c in bumper]), tiled(0.05)),
    ]
    hulls = [pieces.hull(solids.union(case, *chamfer).vertices)]
    return BuiltObject(parts, hulls, mass=0.23, friction=0.9)


def _phone_screen(size: tuple[int, int], wallpaper: tuple[Colour, Colour]) -> np.ndarray:
    """A phone's home screen: the time, sixteen apps and a dock.

    Args:
        size: (width, height), pixels.
        wallpaper: its colours at the top and at the bottom.
    """
    width, height = size
    share = np.repeat(np.linspace(0, 1, height)[:, None], width, axis=1)
    picture = prints.text(blend(*wallpaper, share), "09:41", (0.5, 0.17), 0.1)
    picture = prints.text(picture, "Tuesday 14 May", (0.5, 0.255), 0.032)
    apps = [
        (240, 90, 80),
        (250, 190, 60),
        (90, 190, 110),
        (80, 150, 240),
        (160, 110, 220),
        (240, 240, 244),
        (60, 64, 74),
    ]
    for i in range(16):
        at = (0.155 + 0.23 * (i % 4), 0.37 + 0.115 * (i // 4))
        picture = _tile(picture, at, 0.078, apps[(3 * i + i // 4) % len(apps)])
    picture = prints.rectangle(picture, (0.05, 0.86), (0.95, 0.965), [int(c * 0.75 + 50) for c in wallpaper[1]])
    for i in range(4):
        picture = _tile(picture, (0.155 + 0.23 * i, 0.9125), 0.08, apps[(2 * i + 2) % len(apps)])
    return prints.disc(picture, (0.5, 0.03), 0.013, (10, 10, 12))


def _tile(picture: np.ndarray, at: tuple[float, float], height: float, colour: Colour) -> np.ndarray:
    """A square app with round corners; ``height`` is a share of the picture's."""
    rows, columns = picture.shape[:2]
    x, y, half = at[0] * columns, at[1] * rows, height * rows / 2
    out = Image.fromarray(picture)
    frame = (x - half, y - half, x + half, y + half)
    ImageDraw.Draw(out).rounded_rectangle(frame, radius=half / 2, fill=tuple(int(c) for c in colour))
    return np.asarray(out).copy()
