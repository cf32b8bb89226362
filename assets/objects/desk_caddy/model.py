"""A caddy of four compartments: two long ones in front and at the back, two beside each other between them."""

from __future__ import annotations

from vcage.objects.modelling import materials, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

WIDTH, DEPTH, HEIGHT, WALL, FLOOR = 0.272, 0.194, 0.07, 0.005, 0.006
"""Of the whole, of its walls and its floor, metres."""

ROW = 0.0995
"""Distance of the walls that part the long compartments from the others, metres."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("desk_caddy", variant)
    high = HEIGHT - FLOOR
    boards = [solids.box((WIDTH, DEPTH, FLOOR))]
    boards += [solids.box((WALL, DEPTH, high), (x * (WIDTH - WALL) / 2, 0, FLOOR)) for x in (-1, 1)]
    inner = WIDTH - 2 * WALL
    rows = ((DEPTH - WALL) / 2, 0.0355)
    boards += [solids.box((inner, WALL, high), (0, sign * y, FLOOR)) for y in rows for sign in (-1, 1)]
    boards.append(solids.box((WALL, 2 * 0.0355 - WALL, high), (0, 0, FLOOR)))
    if variant == "wood":
        coat, roughness = materials.wood(rng, materials.BEECH), 0.65
    else:
        coat, roughness = materials.plastic(rng, (238, 237, 232), 128), 0.5
    parts = [paint(solids.union(*boards), coat, tiled(0.14), roughness=roughness)]
    return BuiltObject(parts, boards, mass=1.1, friction=0.9)
