"""A cardboard tube of stacked potato crisps with a plastic lid."""

from __future__ import annotations

import numpy as np

from assets.textures.labels import CODE_AT, coded
from assets.textures.product_faces import brand, darker, ellipse, fading
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, from_above, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "salted": ("SALTED", (206, 34, 40)),
    "onion": ("ONION", (46, 140, 74)),
    "paprika": ("PAPRIKA", (238, 126, 34)),
}
"""Variant → flavour, ground."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("chips_tube", variant)
    flavour, ground = VARIANTS[variant]
    radius, height = 0.0325, 0.165
    tube = solids.revolved([(0, 0), (radius, 0), (radius, height - 0.01), (0, height - 0.01)], 40)
    lid_outline = [(0, height - 0.014), (radius + 0.001, height - 0.014), (radius + 0.001, height - 0.001)]
    lid_outline += [(radius, height), (radius - 0.004, height), (radius - 0.005, height - 0.002), (0, height - 0.002)]
    rim = solids.revolved([(0.02, 0), (radius + 0.0006, 0), (radius + 0.0006, 0.003), (0.02, 0.003)], 40)
    label = fading((1280, 960), ground, darker(ground, 0.75))
    for x in (0.0, 0.5, 1.0):
        label = brand(label, "KRUNCHO", (x, 0.2), 0.07, (255, 244, 200), darker(ground, 0.3))
        label = _crisps(label, rng, (x, 0.42), 0.15)
        label = prints.text(label, flavour, (x, 0.72), 0.06, (255, 250, 236))
        label = prints.text(label, "potato crisps", (x, 0.8), 0.036, (255, 250, 236))
    label = coded(label, ("chips_tube", variant), (CODE_AT, 0.72))
    seal = prints.disc(prints.canvas(256, 256, (238, 238, 234)), (0.5, 0.5), 0.4, ground)
    seal = brand(seal, "KRUNCHO", (0.5, 0.5), 0.13, (255, 244, 200), darker(ground, 0.3))
    parts = [
        paint(tube, label, around(), roughness=0.5),
        paint(rim, materials.brushed(rng), tiled(0.05), roughness=0.35, metallic=0.4),
        paint(solids.revolved(lid_outline, 40), seal, from_above(), roughness=0.35),
    ]
    hulls = [
        pieces.stack([(radius + 0.0006, 0), (radius, 0.004), (radius, height - 0.013)]),
        pieces.stack([(radius + 0.001, height - 0.014), (radius + 0.001, height)]),
    ]
    return BuiltObject(parts, hulls, mass=0.13, friction=0.6)


def _crisps(picture: np.ndarray, rng: np.random.Generator, centre: tuple[float, float], radius: float) -> np.ndarray:
    """The picture with a fan of potato crisps."""
    across = radius * picture.shape[0] / picture.shape[1]
    for i, turn in enumerate((-35, 30, -12, 12, 0)):
        shift = np.sin(np.radians(turn))
        at = (centre[0] + across * shift, centre[1] + 0.1 * radius * abs(shift) + 0.16 * radius * i)
        gold = (242 - 4 * i, 196 - 5 * i, 92)
        picture = ellipse(picture, (at[0], at[1] + 0.05 * radius), (0.75 * radius, 0.42 * radius), darker(gold), turn)
        picture = ellipse(picture, at, (0.74 * radius, 0.4 * radius), gold, turn)
        for _ in range(9):
            spot = rng.uniform(-0.45, 0.45, 2) * (1.0, 0.5)
            place = (at[0] + across * spot[0], at[1] + radius * spot[1])
            picture = prints.disc(picture, place, 0.03 * radius, (190, 110, 40))
    return picture
