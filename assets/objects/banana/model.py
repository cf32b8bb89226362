"""A banana that lies on its side, bent towards the back."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import pieces, solids
from vcage.objects.modelling.mappings import along
from vcage.objects.modelling.noise import blend, clouds, noise, over
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("banana", variant)
    turn = np.radians(np.linspace(215, 325, 27))
    share = np.linspace(0, 1, 27)
    scale = np.interp(
        share, [0, 0.04, 0.12, 0.2, 0.45, 0.8, 0.93, 0.98, 1], [0.34, 0.3, 0.36, 0.78, 1, 0.92, 0.6, 0.3, 0.24]
    )
    radius = 0.0175
    section = solids.circle(radius, 20)
    section = section * (1 + 0.05 * np.cos(np.arange(20) * 5 * 2 * np.pi / 20))[:, None]
    section[:, 1] = np.maximum(section[:, 1], -0.88 * radius)
    path = np.stack([0.098 * np.cos(turn), 0.085 * np.sin(turn), 0.88 * radius * np.maximum(scale, 0.5)], axis=1)
    body = solids.sweep(path, section, scale)
    body.apply_translation((0, 0, -float(body.bounds[0, 2])))
    skin = _banana_skin(rng, ripe=variant == "ripe")
    rings = [np.asarray(body.vertices)[i * 20 : (i + 1) * 20] for i in (0, 2, 5, 8, 11, 14, 17, 20, 23, 26)]
    return BuiltObject([paint(body, skin, along(path), roughness=0.5, crease=55)], pieces.chain(rings), 0.12, 0.7)


def _banana_skin(rng: np.random.Generator, ripe: bool = True) -> np.ndarray:
    """Columns from stem to tip, rows from the bottom up; brown ends, and freckles when ripe."""
    shape = (96, 384)
    low, high = ((232, 186, 44), (250, 216, 84)) if ripe else ((168, 186, 62), (226, 214, 88))
    picture = blend(low, high, clouds(rng, shape, (3, 10)) * 1.6 - 0.3)
    place = np.linspace(0, 1, shape[1])[None] * np.ones((shape[0], 1))
    picture = over(picture, (138, 150, 60), np.clip(1 - place / 0.16, 0, 0.7))
    picture = over(picture, (64, 44, 24), np.clip((0.03 - place) * 60, 0, 0.85) + np.clip((place - 0.965) * 60, 0, 0.9))
    if ripe:
        picture = over(picture, (112, 70, 28), np.clip((noise(rng, shape, (22, 70)) - 0.84) * 8, 0, 0.8))
    return picture
