"""An open square bin, 0.066 m wide and 0.086 m high, that fits between two fingers."""

from __future__ import annotations

from assets.shapes.open_box import open_box
from vcage.objects.modelling import materials
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"blue": (44, 92, 162), "grey": (128, 131, 136)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("small_bin", variant)
    shell, hulls = open_box((0.061, 0.061), 0.0025, 0.005, 0.086, 0.006)
    skin = materials.plastic(rng, COLOURS[variant], 128)
    return BuiltObject([paint(shell, skin, tiled(0.1), roughness=0.5)], hulls, mass=0.05, friction=0.7)
