"""A lime: a smaller, rounder lemon with dark green peel."""

from __future__ import annotations

from assets.shapes.citrus import citrus
from vcage.objects.modelling.parts import BuiltObject, variant_rng

COLOURS = {"green": (88, 140, 44), "pale": (150, 184, 74)}


def build(variant: str) -> BuiltObject:
    colour = COLOURS[variant]
    return citrus(variant_rng("lime", variant), colour, (0.84, 0.74), mass=0.07)
