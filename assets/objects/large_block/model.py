"""A painted wooden cube of 5.5 cm with rounded edges."""

from __future__ import annotations

from assets.shapes.toy_block import toy_block
from vcage.objects.modelling.parts import BuiltObject


def build(variant: str) -> BuiltObject:
    return toy_block("large_block", variant, (0.055, 0.055, 0.055), mass=0.117)
