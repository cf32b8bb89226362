"""A padlock that stands on its keyhole side, bow up."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_front, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

METALS = {"brass": (206, 164, 76), "black": (52, 54, 58), "blue": (34, 84, 160)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("padlock", variant)
    metal = METALS[variant]
    wide, thick, tall, top = 0.048, 0.026, 0.042, 0.074
    body = solids.rounded_box((wide, thick, tall), 0.004, steps=3)
    bend = np.radians(np.linspace(0, 180, 13))
    reach, pipe = 0.0145, 0.0042
    crown = top - reach - pipe
    legs = [(reach, 0, tall - 0.002), (reach, 0, crown - 0.001)]
    path = np.array([*legs, *[(reach * np.cos(t), 0, crown + reach * np.sin(t)) for t in bend[1:-1]]])
    path = np.concatenate([path, path[1::-1] * (-1, 1, 1)])
    bow = solids.sweep(path, solids.circle(pipe, 14), up=(0, 1, 0))
    picture = materials.brushed(rng, metal, 256)
    ink = tuple(int(0.38 * c) for c in metal) if variant == "brass" else (226, 226, 222)
    edge = [(0.08, 0.1), (0.92, 0.1), (0.92, 0.9), (0.08, 0.9)]
    picture = packaging.stroke(picture, edge, 0.014, ink, closed=True)
    picture = packaging.fitted(picture, "BASTION", (0.5, 0.36), (0.64, 0.2), ink)
    picture = packaging.fitted(picture, "50 mm", (0.5, 0.56), (0.3, 0.1), ink)
    picture = prints.disc(picture, (0.5, 0.74), 0.06, (24, 24, 26))
    picture = prints.rectangle(picture, (0.485, 0.72), (0.515, 0.86), (24, 24, 26))
    parts = [
        paint(body, picture, from_front(), roughness=0.3, metallic=0.4),
        paint(bow, materials.brushed(rng), tiled(0.05), roughness=0.2, metallic=0.5),
    ]
    rings = bow.vertices[:-2].reshape(len(path), 14, 3)
    hulls = [body.convex_hull, *pieces.chain([rings[i] for i in range(0, len(path), 2)])]
    if len(path) % 2 == 0:
        hulls.append(pieces.hull(rings[-2], rings[-1]))
    return BuiltObject(parts, hulls, mass=0.28, friction=0.6)
