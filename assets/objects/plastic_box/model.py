"""An open plastic box, 0.25 m wide and 0.07 m high."""

from __future__ import annotations

from assets.shapes.open_box import open_box
from vcage.objects.modelling import materials
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"blue": (62, 118, 186), "white": (238, 238, 234), "grey": (134, 137, 142)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("plastic_box", variant)
    shell, hulls = open_box((0.244, 0.174), 0.003, 0.004, 0.07, 0.008)
    skin = materials.plastic(rng, COLOURS[variant], 128)
    return BuiltObject([paint(shell, skin, tiled(0.1), roughness=0.45)], hulls, mass=0.15, friction=0.8)
