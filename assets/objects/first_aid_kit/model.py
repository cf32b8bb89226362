"""A small first-aid case that stands upright, with a cross on its front and a handle on top."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import six_sides, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {"red": ((196, 30, 34), (250, 250, 248)), "white": ((244, 244, 240), (200, 30, 36))}
"""Variant → ground, mark."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("first_aid_kit", variant)
    ground, mark = VARIANTS[variant]
    size = (0.15, 0.06, 0.1)
    case = solids.rounded_box(size, 0.008, steps=4)
    face = packaging.cross(prints.canvas(480, 320, ground), (0.5, 0.46), 0.3, mark)
    face = packaging.fitted(face, "FIRST AID", (0.5, 0.87), (0.5, 0.09), mark)
    seam = tuple(int(0.7 * c) for c in ground)
    top = prints.rectangle(prints.canvas(480, 320, ground), (0, 0.47), (1, 0.53), seam)
    side = prints.rectangle(prints.canvas(480, 320, ground), (0.46, 0), (0.54, 1), seam)
    picture = prints.atlas({"front": face, "back": face, "top": top, "left": side, "right": side}, ground, (480, 320))
    rise = np.array([(-0.034, 0), (-0.032, 0.01), (-0.024, 0.015), (0.024, 0.015), (0.032, 0.01), (0.034, 0)])
    path = np.column_stack([rise[:, 0], np.zeros(6), rise[:, 1] + size[2] - 0.002])
    grip = solids.sweep(path, solids.circle(1.0, 14) * (0.005, 0.007), up=(0, 1, 0))
    latches = [solids.rounded_box((0.016, 0.006, 0.02), 0.002, (x, -0.028, 0.078)) for x in (-0.05, 0.05)]
    clasp = (60, 62, 68) if variant == "white" else (226, 226, 224)
    parts = [
        paint(case, picture, six_sides(), roughness=0.5),
        paint(grip, materials.plastic(rng, (46, 48, 52)), tiled(0.05), roughness=0.6),
        paint(solids.union(*latches), materials.plastic(rng, clasp), tiled(0.05), roughness=0.4),
    ]
    rings = grip.vertices[:-2].reshape(6, 14, 3)
    hulls = [solids.rounded_box(size, 0.008, steps=2), *pieces.chain(list(rings)), *[x.convex_hull for x in latches]]
    return BuiltObject(parts, hulls, mass=0.26, friction=0.7)
