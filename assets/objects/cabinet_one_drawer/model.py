"""A low cabinet with one drawer."""

from __future__ import annotations

from assets.shapes.cabinet import BAY, with_drawers
from vcage.objects.modelling.parts import BuiltObject


def build(variant: str) -> BuiltObject:
    return with_drawers("cabinet_one_drawer", variant, (BAY,), mass=3.2)
