"""A carrier with two open compartments and a grip above the wall between them."""

from __future__ import annotations

import numpy as np

from assets.shapes import open_box
from assets.textures import packaging
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.parts import BuiltObject, Part, paint, variant_rng

COLOURS = {"red": (190, 40, 40), "grey": (98, 106, 116), "yellow": (238, 186, 40)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("toolbox_tray", variant)
    colour = COLOURS[variant]
    length, room, wall, middle, floor, rim = 0.19, 0.068, 0.005, 0.014, 0.005, 0.04
    inner = (length, 2 * room + middle)
    shell, hulls = open_box.open_box(inner, wall, floor, rim, 0.008)
    top, reach = 0.088, 0.05
    divider = solids.box((length, middle, rim - floor), (0, 0, floor))
    posts = [
        pieces.hull(
            [(side * x, y, rim) for x in (reach - 0.012, length / 2) for y in (-middle / 2, middle / 2)],
            [(side * x, y, top) for x in (reach - 0.012, reach + 0.006) for y in (-middle / 2, middle / 2)],
        )
        for side in (-1, 1)
    ]
    grip = solids.rounded_box((2 * reach - 0.01, 0.0155, 0.018), 0.005, (0, 0, top - 0.018), steps=4)
    parts = [
        paint(solids.union(shell, divider, *posts), materials.plastic(rng, colour), tiled(0.1), roughness=0.5),
        paint(grip, materials.felt(rng, (44, 46, 50)), tiled(0.03), roughness=0.8),
        _mats((length - 0.002, room - 0.002), (room + middle) / 2, floor, rng),
    ]
    return BuiltObject(parts, [*hulls, divider, *posts, grip.convex_hull], mass=0.4, friction=0.7)


def _mats(size: tuple[float, float], offset: float, floor: float, rng: np.random.Generator) -> Part:
    """Rubber mats, 0.4 mm thick, on the floors of the front and the back compartment."""
    mats = [solids.box((*size, 0.0004), (0, side * offset, floor - 0.0001)) for side in (-1, 1)]
    return paint(solids.union(*mats), packaging.knurled(rng, (64, 66, 70), cells=24), from_above(), roughness=0.9)
