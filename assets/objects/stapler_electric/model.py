"""An electric stapler: a heavy body with a slot for paper in front, and a large button on its head."""

from __future__ import annotations

import numpy as np

from assets.shapes.push_button import push_button
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.lofts import across
from vcage.objects.modelling.mappings import from_front, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"black": ((46, 47, 51), (214, 60, 48)), "white": ((236, 235, 231), (70, 110, 170))}
"""Variant → body, button."""

WIDTH = 0.072
"""Metres."""

SIDE = ((-0.085, 0.0), (0.07, 0.0), (0.075, 0.005), (0.072, 0.06), (0.05, 0.078), (-0.048, 0.078), (-0.066, 0.066))
"""y and z of the outline seen from the right, without the slot, from the front's foot on, metres."""

SLOT = (0.019, 0.029)
"""Heights of the lower and upper edge of the slot for paper, metres."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("stapler_electric", variant)
    colour, accent = COLOURS[variant]
    whole = across(np.array([*SIDE, (-0.07, 0.03), (-0.085, 0.022)]), WIDTH)
    slot = solids.box((WIDTH + 0.02, 0.075, SLOT[1] - SLOT[0]), (0, -0.0625, SLOT[0]))
    body = solids.cut(whole, slot)
    plate = solids.box((0.02, 0.03, 0.0008), (0, -0.06, SLOT[0] - 0.0002))
    label = prints.text(prints.canvas(300, 90, colour), "STAPLO 20", (0.5, 0.5), 0.5, accent)
    sign = solids.box((0.04, 0.0008, 0.012), (0, -0.0693, 0.042))
    parts = [
        paint(body, materials.plastic(rng, colour, 128), tiled(0.06), roughness=0.4, crease=35),
        paint(plate, materials.brushed(rng), tiled(0.05), roughness=0.3, metallic=0.5),
        paint(sign, label, from_front(), roughness=0.5),
    ]
    foot = pieces.hull(_slab(((-0.085, 0.0), (0.072, 0.0), (0.072, SLOT[0]), (-0.085, SLOT[0]))))
    back = pieces.hull(_slab(((-0.024, SLOT[0]), (0.075, SLOT[0]), (0.075, SLOT[1]), (-0.024, SLOT[1]))))
    head = pieces.hull(_slab(((-0.07, SLOT[1]), (0.075, SLOT[1]), *SIDE[3:])))
    button = push_button(rng, (0.034, 0.03, 0.008), (0, -0.012, 0.0845), accent)
    return BuiltObject(parts, [foot, back, head], mass=1.1, friction=1.0, moving=[button])


def _slab(outline: tuple[tuple[float, float], ...]) -> np.ndarray:
    """(n, 3) corners of a prism across the whole width."""
    return np.array([(sign * WIDTH / 2, y, z) for y, z in outline for sign in (-1, 1)])
