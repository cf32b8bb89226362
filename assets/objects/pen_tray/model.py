"""A long low tray for pens, its end walls thick enough to hold."""

from __future__ import annotations

import numpy as np

from assets.shapes import open_box
from vcage.objects.modelling import materials, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, Part, paint, variant_rng

FELTS = {"bamboo": (96, 110, 100), "black": (120, 124, 130), "mint": (236, 240, 236)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("pen_tray", variant)
    inner, wall, floor, height = (0.2, 0.072), 0.009, 0.006, 0.03
    body, hulls = open_box.open_box(inner, wall, floor, height, 0.01)
    if variant == "bamboo":
        part = paint(body, materials.wood(rng, materials.PINE), tiled(0.14), roughness=0.7)
    else:
        colour = {"black": (50, 50, 54), "mint": (150, 206, 186)}[variant]
        part = paint(body, materials.plastic(rng, colour), tiled(0.1), roughness=0.5)
    felt = FELTS[variant]
    return BuiltObject([part, _lining(rng, inner, floor, felt)], hulls, mass=0.25, friction=0.7)


def _lining(rng: np.random.Generator, inner: tuple[float, float], floor: float, colour: tuple[int, int, int]) -> Part:
    """Felt on the floor of a tray, 0.4 mm above it."""
    sheet = solids.prism(solids.rounded_rectangle((inner[0] - 0.002, inner[1] - 0.002), 0.003), 0.0006, floor - 0.0002)
    return paint(sheet, materials.felt(rng, colour), tiled(0.05), roughness=0.95)
