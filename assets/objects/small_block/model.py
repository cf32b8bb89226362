"""A painted wooden cube of 3 cm with rounded edges."""

from __future__ import annotations

from assets.shapes.toy_block import toy_block
from vcage.objects.modelling.parts import BuiltObject


def build(variant: str) -> BuiltObject:
    return toy_block("small_block", variant, (0.03, 0.03, 0.03), mass=0.019)
