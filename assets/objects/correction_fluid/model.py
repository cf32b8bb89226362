"""A small bottle of white correction fluid with a brush cap."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import pieces, solids
from vcage.objects.modelling.mappings import around
from vcage.objects.modelling.parts import BuiltObject, paint

ACCENTS = {"blue": (34, 96, 176), "green": (44, 138, 84)}


def build(variant: str) -> BuiltObject:
    accent = ACCENTS[variant]
    radius, shoulder, height = 0.017, 0.044, 0.078
    body = [(0, 0), (radius - 0.002, 0), (radius, 0.002), (radius, shoulder - 0.007)]
    body = np.concatenate([body, solids.arc((0.0105, shoulder - 0.007), (radius - 0.0105, 0.007), 15, 90, 6)])
    cap = [(0, shoulder), (0.0125, shoulder), (0.012, height - 0.012), (0.0105, height - 0.002), (0.009, height)]
    lines = [("BLANCO", 0.4, 0.26, 0.2, (250, 250, 250)), ("correction fluid", 0.66, 0.26, 0.11, accent)]
    label = packaging.label((512, 208), (250, 250, 248), lines, [(0.26, 0.54, accent)])
    ribs = packaging.striped([accent, tuple(int(0.8 * c) for c in accent)], 40)
    parts = [
        paint(solids.revolved([*body, (0, shoulder)], 40), label, around(), roughness=0.3),
        paint(solids.revolved([*cap, (0, height)], 36), ribs, around(), roughness=0.45),
    ]
    hulls = [
        pieces.stack([(radius - 0.001, 0), (radius, 0.002), (radius, shoulder - 0.006), (0.0125, shoulder)]),
        pieces.stack([(0.0125, shoulder), (0.012, height - 0.012), (0.01, height)]),
    ]
    return BuiltObject(parts, hulls, mass=0.045, friction=0.7)
