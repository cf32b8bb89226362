"""A small bottle of pills with a ribbed safety cap."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, from_above
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "orange": ((214, 106, 22), (246, 246, 244), (40, 84, 150), "TABLETS"),
    "white": ((244, 244, 242), (70, 150, 90), (60, 140, 80), "VITAMIN C"),
}
"""Variant → ground, lid, accent, words."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("pill_bottle", variant)
    ground, lid, accent, words = VARIANTS[variant]
    radius, shoulder, height = 0.0215, 0.052, 0.073
    body = [(0, 0), (radius - 0.002, 0), (radius, 0.002), (radius, shoulder - 0.004), (radius - 0.004, shoulder)]
    cap = [(0, shoulder), (0.0225, shoulder), (0.0225, height - 0.0015), (0.021, height), (0, height)]
    paper = solids.revolved([(0.015, 0.007), (radius + 0.0003, 0.007), (radius + 0.0003, 0.042), (0.015, 0.042)], 40)
    label = packaging.label((640, 168), (250, 249, 246), [], [(0, 0.3, accent)])
    for x in (0.0, 0.5, 1.0):
        label = packaging.fitted(label, words, (x, 0.15), (0.26, 0.18), (252, 252, 250))
        label = packaging.fitted(label, "Take 1 a day", (x, 0.45), (0.22, 0.12), (40, 42, 48))
        for row, reach in ((0.6, 0.12), (0.7, 0.1), (0.8, 0.12), (0.9, 0.07)):
            label = prints.rectangle(label, (max(0, x - reach), row), (min(1, x + reach), row + 0.035), (150, 152, 158))
    tablets = packaging.cotton(rng, tuple(int(0.6 * c + 70) for c in ground), (512, 256))
    glass = tablets if variant == "orange" else materials.plastic(rng, ground)
    if variant == "orange":
        glass = (0.45 * glass + 0.55 * np.asarray(ground)).astype(np.uint8)
    dark = tuple(int(0.82 * c) for c in lid)
    top = [(0.0, height - 0.0002), (0.0195, height - 0.0002), (0.0195, height + 0.0003), (0, height + 0.0003)]
    disc = prints.canvas(192, 192, lid)
    disc = packaging.fitted(disc, "PUSH DOWN", (0.5, 0.4), (0.7, 0.12), dark)
    disc = packaging.fitted(disc, "& TURN", (0.5, 0.6), (0.45, 0.12), dark)
    parts = [
        paint(solids.revolved([*body, (0, shoulder)], 40), glass, around(), roughness=0.2),
        paint(paper, label, around(), roughness=0.6),
        paint(solids.revolved(cap, 40), packaging.striped([lid, dark], 64), around(), roughness=0.45),
        paint(solids.revolved(top, 40), disc, from_above(), roughness=0.45),
    ]
    hulls = [
        pieces.stack([(radius - 0.001, 0), (radius + 0.0003, 0.002), (radius + 0.0003, shoulder)]),
        pieces.stack([(0.0225, shoulder), (0.0225, height)]),
    ]
    return BuiltObject(parts, hulls, mass=0.07, friction=0.6)
