"""A square peg of 14 cm, its ends bevelled.

It is held at most 3 cm from its middle, where it does not turn between fingers, and 10 cm of it are free then.
"""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

LENGTH, THICK, BEVEL = 0.14, 0.024, 0.003
PAINTS = {"red": (196, 42, 38), "blue": (38, 82, 178), "yellow": (226, 182, 44)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("peg", variant)
    coat = materials.plastic(rng, PAINTS[variant], 128)
    square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * 0.5
    rings = [(side * (LENGTH / 2 - depth), THICK - 2 * (BEVEL - depth)) for side in (-1, 1) for depth in (0.0, BEVEL)]
    body = pieces.hull(*[np.column_stack([np.full(4, x), square * width]) for x, width in rings])
    return BuiltObject([paint(body, coat, tiled(0.1), crease=20.0, roughness=0.5)], [body], mass=0.06, friction=0.5)
