"""A cabinet with two tall drawers: a wine bottle stands in the lower one, a ketchup bottle in the upper one."""

from __future__ import annotations

from assets.shapes.cabinet import with_drawers
from vcage.objects.modelling.parts import BuiltObject


def build(variant: str) -> BuiltObject:
    return with_drawers("tall_drawer_cabinet", variant, (0.2, 0.182), mass=6.5, foot_height=0.016)
