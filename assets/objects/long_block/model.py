"""A painted wooden bar as long as three blocks, lying on its side: two hands have room on it."""

from __future__ import annotations

from assets.shapes.toy_block import toy_block
from vcage.objects.modelling.parts import BuiltObject


def build(variant: str) -> BuiltObject:
    return toy_block("long_block", variant, (0.12, 0.032, 0.032), mass=0.086)
