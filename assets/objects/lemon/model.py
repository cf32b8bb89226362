"""A lemon of 0.077 m that lies along x on a small flat underside."""

from __future__ import annotations

from assets.shapes.citrus import citrus
from vcage.objects.modelling.parts import BuiltObject, variant_rng

COLOURS = {"ripe": (244, 206, 44), "unripe": (206, 202, 62)}


def build(variant: str) -> BuiltObject:
    colour = COLOURS[variant]
    return citrus(variant_rng("lemon", variant), colour, (1.0, 1.0), mass=0.11)
