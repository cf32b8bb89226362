"""A low hand basket with slotted walls, 0.23 × 0.16 m inside; its two handles are folded outwards."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_above, six_sides, tiled
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, Part, paint, variant_rng

COLOURS = {"red": (204, 40, 44), "blue": (36, 92, 176), "green": (52, 140, 72)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("shopping_basket", variant)
    colour = COLOURS[variant]
    inner, wall, floor, height = (0.23, 0.16), 0.006, 0.004, 0.048
    outer = (inner[0] + 2 * wall, inner[1] + 2 * wall)
    shell = solids.prism(solids.rounded_rectangle(outer, 0.01), height)
    rim = solids.prism(solids.rounded_rectangle((outer[0] + 0.008, outer[1] + 0.008), 0.012), 0.014, height - 0.014)
    hollow = solids.prism(solids.rounded_rectangle(inner, 0.008), 1.0, floor - 0.0008)
    bottom = solids.prism(solids.rounded_rectangle(inner, 0.008), 0.0009, floor - 0.0009)
    body = solids.cut(solids.union(shell, rim), hollow, *_slots())
    grey = materials.plastic(rng, (64, 66, 72))
    parts = [
        paint(body, materials.plastic(rng, colour), tiled(0.1), roughness=0.45),
        paint(bottom, _slotted_floor((520, 340), colour), from_above(), roughness=0.5),
    ]
    hulls = pieces.tray(inner, wall, floor, height)
    for side in (-1, 1):
        hulls += [
            solids.box((0.004, outer[1] - 0.01, 0.014), (side * (outer[0] / 2 + 0.002), 0, height - 0.014)),
            solids.box((outer[0] - 0.01, 0.004, 0.014), (0, side * (outer[1] / 2 + 0.002), height - 0.014)),
        ]
        bars = _handle(side, outer[1] / 2, height - 0.019)
        parts.append(paint(solids.union(*bars), grey, tiled(0.05), roughness=0.6))
        hulls += [bar.convex_hull for bar in bars]
        parts.append(_shop_name(side, outer[0] / 2))
    return BuiltObject(parts, hulls, mass=0.18, friction=0.8)


def _slots() -> list[solids.Solid]:
    """Cutters of upright slots through all four walls, none where the name is."""
    tools = [solids.box((0.01, 1.0, 0.02), (0.0185 * i, 0, 0.011)) for i in range(-5, 6)]
    for y in 0.0185 * np.arange(-3, 4):
        if abs(y) > 0.05:
            tools.append(solids.box((1.0, 0.01, 0.02), (0, y, 0.011)))
    return tools


def _handle(side: int, edge: float, z: float) -> list[solids.Solid]:
    """Grip and two arms of a handle that lies outside the long wall at y = ±edge."""
    reach = 0.043
    grip = solids.rounded_box((0.13, 0.012, 0.018), 0.0025, (0, side * (edge + reach), z))
    arms = [
        solids.rounded_box((0.008, reach + 0.004, 0.008), 0.002, (x, side * (edge + reach / 2), z + 0.008), steps=2)
        for x in (-0.058, 0.058)
    ]
    return [grip, *arms]


def _shop_name(side: int, edge: float) -> Part:
    """A white plate with the shop's name on a short wall, at x = ±edge."""
    picture = prints.text(prints.canvas(384, 96, (250, 250, 246)), "FRESKO", (0.5, 0.5), 0.66, (50, 60, 66))
    plate = solids.box((0.0012, 0.086, 0.021), (side * edge, 0, 0.0105))
    sides = {"left": picture, "right": picture}
    return paint(plate, prints.atlas(sides, (250, 250, 246), (384, 96)), six_sides(), roughness=0.5)


def _slotted_floor(size: tuple[int, int], colour: Colour) -> np.ndarray:
    """The floor of a plastic basket: rows of dark slots."""
    picture = prints.canvas(*size, colour)
    dark = tuple(int(0.42 * c) for c in colour)
    for row in range(7):
        for column in range(12):
            x, y = (column + 0.78) / 12.56, (row + 0.78) / 7.56
            picture = prints.rectangle(picture, (x - 0.022, y - 0.034), (x + 0.022, y + 0.034), dark)
    return picture
