"""A bath duck that looks to the front."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {"yellow": ((250, 206, 40), (238, 120, 30)), "pink": ((246, 150, 180), (246, 190, 60))}
"""Variant → colour, beak colour."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("rubber_duck", variant)
    colour, beak_colour = VARIANTS[variant]
    body = solids.above(solids.ellipsoid((0.0315, 0.041, 0.0265), (0, 0.004, 0.0245), 28), 0.0012)
    head = solids.ellipsoid((0.0205, 0.021, 0.0205), (0, -0.014, 0.0575), 26)
    tail = solids.moved(solids.ellipsoid((0.012, 0.018, 0.007), count=14), (0, 0.04, 0.039), turn=38, axis=(1, 0, 0))
    wings = [
        solids.moved(
            solids.ellipsoid((0.006, 0.02, 0.012), count=16), (side * 0.0295, 0.009, 0.029), turn=14, axis=(1, 0, 0)
        )
        for side in (-1, 1)
    ]
    beak = solids.union(
        solids.ellipsoid((0.0105, 0.0125, 0.0038), (0, -0.036, 0.0545), 16),
        solids.ellipsoid((0.0085, 0.01, 0.003), (0, -0.034, 0.0505), 16),
    )
    skin = solids.union(body, head, tail, *wings)
    parts = [
        paint(skin, materials.plastic(rng, colour), tiled(0.1), roughness=0.35),
        paint(beak, materials.plastic(rng, beak_colour), tiled(0.1), roughness=0.35),
    ]
    for reach, radius, tint in ((0.0, 0.0046, (250, 250, 250)), (0.0019, 0.0034, (20, 20, 24))):
        eyes = []
        for side in (-1, 1):
            out = np.array([side * 0.52, -0.76, 0.4]) / np.linalg.norm([0.52, 0.76, 0.4])
            eyes.append(solids.ellipsoid([radius] * 3, np.array([0, -0.014, 0.0575]) + out * (0.0182 + reach), 10))
        parts.append(paint(solids.union(*eyes), materials.plastic(rng, tint), tiled(0.1), roughness=0.15))
    hulls = [pieces.coarse(_visible(skin, solid), 90) for solid in (body, head, tail, *wings)]
    hulls.append(pieces.coarse(beak.vertices))
    return BuiltObject(parts, hulls, mass=0.06, friction=0.8)


def _visible(skin: solids.Solid, solid: solids.Solid) -> np.ndarray:
    """The corners (n, 3) of a union that lie on the surface of one of its convex solids."""
    offsets = np.einsum("ij,ij->i", solid.face_normals, solid.triangles[:, 0])
    outside = (skin.vertices @ solid.face_normals.T - offsets).max(axis=1)
    return skin.vertices[np.abs(outside) < 1e-5]
