"""A number pad with seventeen raised keys, tilted a little towards the user."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, Part, paint, variant_rng

PAD = (("num", "/", "*", "-"), ("7", "8", "9", "+"), ("4", "5", "6", ""), ("1", "2", "3", "enter"), ("0", "", ".", ""))
"""Legends of a number pad's keys, row by row from the back; the empty ones belong to a larger neighbour."""

VARIANTS = {
    "black": ((40, 41, 45), (66, 68, 74), (238, 238, 238), (206, 92, 40)),
    "white": ((232, 231, 226), (248, 247, 243), (52, 54, 60), (96, 152, 206)),
}
"""Variant → case, caps, ink, accent."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("numeric_keypad", variant)
    case, caps, ink, accent = VARIANTS[variant]
    width, length, pitch = 0.066, 0.092, 0.0155
    outline = solids.rounded_rectangle((width, length), 0.005)
    body = solids.prism(outline, 0.02)
    body.vertices[:, 2] += np.where(body.vertices[:, 2] > 0.01, 0.05 * body.vertices[:, 1], 0)
    cable = solids.moved(
        solids.revolved([(0, 0), (0.0028, 0), (0.002, 0.006), (0, 0.006)], 16),
        (0, 0.0455, 0.010),
        turn=-90,
        axis=(1, 0, 0),
    )
    parts = [
        paint(body, materials.plastic(rng, case, 128), tiled(0.06), roughness=0.6),
        paint(cable, materials.plastic(rng, (28, 28, 30)), tiled(0.05), roughness=0.9),
    ]
    for row, legends in enumerate(PAD):
        for column, legend in enumerate(legends):
            if not legend:
                continue
            wide, tall = {"0": (2, 1), "+": (1, 2), "enter": (1, 2)}.get(legend, (1, 1))
            x, y = (column + wide / 2 - 2) * pitch, (2.5 - row - tall / 2) * pitch
            ground = accent if legend in ("+", "enter", "num") else caps
            parts.append(_cap(legend, (wide * pitch, tall * pitch), (x, y - 0.002), ground, ink))
    top = [(x, y, 0.0258 + 0.05 * y) for x in (-0.0295, 0.0295) for y in (-0.039, 0.035)]
    under = [(x, y, 0.015) for x, y, _ in top]
    hulls = [pieces.hull(body.vertices), pieces.hull(top, under), pieces.hull(cable.vertices)]
    return BuiltObject(parts, hulls, mass=0.16, friction=0.8)


def _cap(legend: str, size: tuple[float, float], at: tuple[float, float], ground: Colour, ink: Colour) -> Part:
    """One key, narrower at its top, with its legend."""
    half = np.array(size) / 2 - 0.0006
    z = 0.02 + 0.05 * at[1]
    rings = [
        np.column_stack([solids.rounded_rectangle(2 * (half - inset), 0.0015, 2) + at, np.full(12, z + rise)])
        for inset, rise in ((0, -0.002), (0.0003, 0.003), (0.0016, 0.0057), (0.0024, 0.006))
    ]
    solid = solids.closed_rings(rings)
    rows = round(64 * size[1] / 0.0155)
    picture = prints.canvas(round(64 * size[0] / 0.0155), rows, ground)
    height = (30 if len(legend) == 1 else 15) / rows
    return paint(solid, prints.text(picture, legend, (0.5, 0.5), height, ink), from_above(), roughness=0.6)
