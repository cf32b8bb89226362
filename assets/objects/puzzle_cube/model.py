"""A turning-puzzle cube with coloured stickers, scrambled by the variant's seed."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import prints, solids
from vcage.objects.modelling.mappings import six_sides
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("puzzle_cube", variant)
    colours = [(250, 250, 248), (250, 214, 30), (200, 30, 40), (244, 120, 24), (20, 90, 190), (20, 150, 80)]
    stickers = np.repeat(np.arange(6), 9)
    if variant == "scrambled":
        stickers = rng.permutation(stickers)
    sides = {}
    for i, side in enumerate(("top", "bottom", "front", "back", "left", "right")):
        picture = prints.canvas(192, 192, (22, 22, 24))
        for k, sticker in enumerate(stickers[9 * i : 9 * i + 9]):
            x, y = k % 3 / 3, k // 3 / 3
            picture = prints.rectangle(picture, (x + 0.03, y + 0.03), (x + 0.305, y + 0.305), colours[sticker])
        sides[side] = picture
    edge = 0.056
    cube = solids.rounded_box((edge, edge, edge), 0.003)
    part = paint(cube, prints.atlas(sides, (22, 22, 24)), six_sides(), roughness=0.4)
    return BuiltObject([part], [solids.box((edge, edge, edge))], mass=0.09, friction=0.6)
