"""A tent of card with a month on its front and wire rings along the ridge."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import lofts, materials, pieces, prints, solids
from vcage.objects.modelling.mappings import six_sides, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "blue": ((36, 92, 168), "JUNE", 0, 30),
    "red": ((196, 42, 46), "MARCH", 6, 31),
    "green": ((46, 128, 84), "SEPTEMBER", 1, 30),
}
"""Variant → accent, month, first, days."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("desk_calendar", variant)
    accent, month, first, days = VARIANTS[variant]
    width, half, tall, card = 0.15, 0.034, 0.118, 0.0022
    page = packaging.calendar_page(month, first, days, accent)
    plates, sheets = [], []
    for sign in (-1, 1):
        foot, ridge = np.array([sign * half, 0.0]), np.array([sign * 0.0012, tall])
        along = (ridge - foot) / np.linalg.norm(ridge - foot)
        away = sign * np.array([along[1], -along[0]])  # out of the plate
        plates.append(pieces.across([foot - (sign * card, 0), ridge - (sign * card, 0), ridge, foot], width))
        low, high = foot + 0.008 * along, ridge - 0.011 * along
        block = [low - 0.0004 * away, low + 0.0012 * away, high + 0.0012 * away, high - 0.0004 * away]
        sheets.append(pieces.across(block, width - 0.006))
    hulls = [*plates, *sheets]
    base = solids.box((width, 2 * half - 0.002, card))
    angle = np.arange(10) * 2 * np.pi / 10
    loops = []
    for x in np.linspace(-0.062, 0.062, 14):
        ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        loop = solids.cut(lofts.across(ring * 0.0072, 0.0014), lofts.across(ring * 0.0058, 0.01))
        loops.append(solids.moved(loop, (x, 0, tall - 0.003)))
    hulls += [base, solids.box((0.1254, 0.011, 0.013), (0, 0, tall - 0.0095))]
    stand = materials.plastic(rng, tuple(int(0.75 * c) for c in accent))
    parts = [
        paint(solids.union(*plates, base), stand, tiled(0.1), roughness=0.7),
        *[
            paint(sheet, prints.atlas({"front": page, "back": page}, (250, 249, 245), (448, 352)), six_sides())
            for sheet in sheets
        ],
        paint(solids.union(*loops), materials.brushed(rng, (70, 72, 76)), tiled(0.05), roughness=0.3, metallic=0.4),
    ]
    return BuiltObject(parts, hulls, mass=0.14, friction=0.7)
