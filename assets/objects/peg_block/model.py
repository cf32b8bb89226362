"""A block of 6 × 10 × 8.5 cm with a square hole from left to right, its mouths bevelled.

The hole is 3 mm wider on each side than the peg, as in ManiSkill's PegInsertionSide. Little of the block is above it:
the palm of a hand with short fingers passes over.
"""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

DEPTH, WIDTH, HEIGHT = 0.06, 0.1, 0.085
HOLE, MIDDLE, BEVEL = 0.03, 0.055, 0.003
"""Width of the hole, height of its middle, and width and depth of the bevel around its mouths, metres."""

PAINTS = {"green": (46, 122, 70), "blue": (38, 82, 178), "black": (40, 40, 42)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("peg_block", variant)
    coat = materials.plastic(rng, PAINTS[variant], 128)
    mouth = HOLE / 2 + BEVEL
    walls = [
        solids.box((DEPTH, WIDTH, MIDDLE - mouth)),
        solids.box((DEPTH, WIDTH, HEIGHT - MIDDLE - mouth), (0, 0, MIDDLE + mouth)),
    ]
    aside = WIDTH / 2 - mouth
    walls += [
        solids.box((DEPTH, aside, 2 * mouth), (0, side * (mouth + aside / 2), MIDDLE - mouth)) for side in (-1, 1)
    ]
    walls += [_lining(quarter, mouth) for quarter in range(4)]
    seen = paint(solids.union(*walls), coat, tiled(0.15), crease=20.0, roughness=0.5)
    return BuiltObject([seen], walls, mass=1.5, friction=0.8)


def _lining(quarter: int, mouth: float) -> pieces.Piece:
    """One of the four linings of the hole, bevelled towards both mouths."""
    wide = [(x, y, -mouth) for x in (-DEPTH / 2, DEPTH / 2) for y in (-mouth, mouth)]
    narrow = [(x, y, -HOLE / 2) for x in (BEVEL - DEPTH / 2, DEPTH / 2 - BEVEL) for y in (-mouth, mouth)]
    return solids.moved(
        solids.moved(pieces.hull(np.array(wide + narrow)), turn=90.0 * quarter, axis=(1, 0, 0)), (0, 0, MIDDLE)
    )
