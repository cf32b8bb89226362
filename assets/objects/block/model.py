"""A painted wooden cube of 4 cm with rounded edges."""

from __future__ import annotations

from assets.shapes.toy_cube import toy_cube
from vcage.objects.modelling.parts import BuiltObject


def build(variant: str) -> BuiltObject:
    return toy_cube("block", variant, 0.04, mass=0.045)
