"""A slim drink can with a necked top and a ring-pull."""

from __future__ import annotations

import cv2
import numpy as np

from assets.textures.labels import CODE_AT, coded
from assets.textures.product_faces import brand, darker, fading
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "volt": ("VOLTA", (24, 26, 30), (150, 230, 50)),
    "ice": ("GLACIO", (206, 214, 222), (30, 90, 190)),
    "berry": ("RUSH", (150, 24, 70), (255, 214, 90)),
}
"""Variant → name, ground, ink."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("energy_drink", variant)
    name, ground, ink = VARIANTS[variant]
    radius, neck, height = 0.0265, 0.0235, 0.134
    can = [(0, 0.003), (0.0195, 0.003), (0.021, 0), (0.0225, 0), (radius, 0.009), (radius, height - 0.013)]
    can += [(neck, height - 0.003), (neck + 0.0006, height - 0.001), (neck, height), (neck - 0.0015, height)]
    can += [(neck - 0.002, height - 0.004), (0, height - 0.004)]
    band = [(0.015, 0.009), (radius + 0.0002, 0.009), (radius + 0.0002, height - 0.013), (0.015, height - 0.013)]
    label = fading((1024, 688), ground, darker(ground, 0.8))
    for x in (0.0, 0.5, 1.0):
        label = _flash(label, (x, 0.6), 0.5, ink)
        label = brand(label, name, (x, 0.22), 0.115 if len(name) < 6 else 0.1, ink, darker(ground, 0.4))
        label = prints.text(label, "ENERGY DRINK", (x, 0.35), 0.045, ink)
    label = coded(label, ("energy_drink", variant), (CODE_AT, 0.72))
    pull = solids.prism(solids.circle(1.0, 20) * (0.0075, 0.011), 0.0012, height - 0.0042)
    pull = solids.cut(pull, solids.prism(solids.circle(1.0, 16, (0, -0.5)) * (0.0042, 0.005), 0.01, height - 0.006))
    tin = materials.brushed(rng, (214, 216, 220))
    parts = [
        paint(solids.revolved(can, 40), tin, tiled(0.05), roughness=0.3, metallic=0.4),
        paint(solids.revolved(band, 40), label, around(), roughness=0.3),
        paint(pull, materials.brushed(rng, (176, 178, 184)), tiled(0.02), roughness=0.3, metallic=0.4),
    ]
    outline = [(0.0225, 0), (radius, 0.009), (radius, height - 0.013), (neck + 0.0003, height - 0.003), (neck, height)]
    return BuiltObject(parts, [pieces.stack(outline)], mass=0.27, friction=0.6)


def _flash(picture: np.ndarray, centre: tuple[float, float], height: float, colour: Colour) -> np.ndarray:
    """The picture with a flash of lightning, ``height`` as a share of the picture's."""
    outline = np.array([(0.15, -0.5), (-0.3, 0.08), (-0.03, 0.08), (-0.15, 0.5), (0.3, -0.1), (0.03, -0.1)])
    rows, columns = picture.shape[:2]
    points = outline * height * rows * (0.6, 1.0) + np.array(centre) * (columns, rows)
    return cv2.fillPoly(picture.copy(), [points.round().astype(np.int32)], tuple(colour), cv2.LINE_AA)
