"""A glass jar of cotton with a wooden lid and a knob."""

from __future__ import annotations

import cv2
import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("cotton_jar", variant)
    if variant == "balls":
        inside, timber, words = packaging.cotton(rng), materials.BEECH, "cotton balls"
    else:
        inside = _swabs(rng, {"swabs": (120, 176, 216)}[variant])
        timber, words = materials.WALNUT, "cotton swabs"
    radius, seam, lid = 0.0315, 0.072, 0.081
    jar = [(0, 0), (radius - 0.003, 0), (radius, 0.003), (radius, seam - 0.005), (radius - 0.002, seam), (0, seam)]
    inside = prints.rectangle(inside, (0, 0.95), (1, 1), (206, 220, 226))
    for x in (0.0, 0.5, 1.0):
        low, high = max(0.0, x - 0.14), min(1.0, x + 0.14)
        inside = prints.rectangle(inside, (low, 0.42), (high, 0.66), (250, 248, 240))
        inside = packaging.fitted(inside, words, (x, 0.54), (0.24, 0.12), (70, 66, 60))
    top = [(0, seam), (radius, seam), (radius, lid - 0.002), (radius - 0.002, lid), (0, lid)]
    knob = [(0, lid - 0.001), (0.006, lid - 0.001), (0.006, lid + 0.003)]
    knob = np.concatenate([knob, solids.arc((0, lid + 0.012), (0.0115, 0.0095), -55, 90, 10)])
    wood = solids.union(solids.revolved(top, 44), solids.revolved(knob, 28))
    parts = [
        paint(solids.revolved(jar, 44), inside, around(), roughness=0.12),
        paint(wood, materials.wood(rng, timber), tiled(0.1), roughness=0.65),
    ]
    hulls = [
        pieces.stack([(radius - 0.002, 0), (radius, 0.003), (radius, seam)]),
        pieces.stack([(radius, seam), (radius, lid)]),
        pieces.stack([(0.006, lid - 0.001), (0.006, lid + 0.005)], 12),
        pieces.coarse(solids.revolved(knob[3:], 24).vertices, 90),
    ]
    return BuiltObject(parts, hulls, mass=0.2, friction=0.7)


def _swabs(rng: np.random.Generator, stick: Colour, size: tuple[int, int] = (512, 256)) -> np.ndarray:
    """Cotton swabs that stand behind glass, ``size`` (width, height): sticks with white tips."""
    width, height = size
    picture = prints.canvas(width, height, tuple(int(0.6 * c) for c in stick))
    for number, x in enumerate(range(4, width, 11)):
        drop = int(rng.integers(0, height // 12))
        tone = 0.86 + 0.14 * (number % 2)
        cv2.line(picture, (x, drop + 30), (x, height), tuple(int(c * tone) for c in stick), 6, cv2.LINE_AA)
        cv2.ellipse(picture, (x, drop + 24), (7, 22), 0, 0, 360, (252, 252, 250), -1, cv2.LINE_AA)
    return picture
