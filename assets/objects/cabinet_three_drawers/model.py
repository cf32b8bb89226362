"""A cabinet with three drawers, one above the other."""

from __future__ import annotations

from assets.shapes.cabinet import BAY, with_drawers
from vcage.objects.modelling.parts import BuiltObject


def build(variant: str) -> BuiltObject:
    return with_drawers("cabinet_three_drawers", variant, (BAY,) * 3, mass=5.2)
