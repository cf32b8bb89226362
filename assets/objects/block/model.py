"""A painted wooden cube of 4 cm with rounded edges."""

from __future__ import annotations

from assets.shapes.toy_block import toy_block
from vcage.objects.modelling.parts import BuiltObject


def build(variant: str) -> BuiltObject:
    return toy_block("block", variant, (0.04, 0.04, 0.04), mass=0.045)
