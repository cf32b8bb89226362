"""A cabinet with two drawers, one above the other."""

from __future__ import annotations

from assets.shapes.cabinet import BAY, with_drawers
from vcage.objects.modelling.parts import BuiltObject


def build(variant: str) -> BuiltObject:
    return with_drawers("cabinet_two_drawers", variant, (BAY,) * 2, mass=4.2)
