"""An open cardboard box, 0.22 × 0.18 m inside, with the long flaps folded down outside."""

from __future__ import annotations

from assets.shapes.open_box import front_sign, open_shell
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"brown": (190, 148, 100), "white": (228, 226, 220)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("packaging_box", variant)
    colour = COLOURS[variant]
    inner, wall, floor, height = (0.22, 0.18), 0.004, 0.004, 0.044
    flap = 0.004
    shell = open_shell(inner, wall, floor, height)
    board = materials.cardboard(rng, colour)
    parts = [paint(shell, board, tiled(0.12), roughness=0.9)]
    hulls = pieces.tray(inner, wall, floor, height)
    for side in (-1, 1):
        middle = side * (inner[1] / 2 + wall + flap / 2)
        leaf = solids.box((inner[0] - 0.01, flap, height - 0.014), (0, middle, 0.013))
        parts.append(paint(leaf, materials.cardboard(rng, colour), tiled(0.12), roughness=0.9))
        hulls.append(leaf)
    parts.append(front_sign("THIS SIDE UP", 0.1, 0.026, (0, -inner[1] / 2 - wall - flap, 0.019), colour, (70, 50, 34)))
    return BuiltObject(parts, hulls, mass=0.16, friction=0.6)
