"""A brush that lies on its back along x, bristles up at the left, thick handle to the right."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import lofts, materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

CUSHION_COLOURS = {"wood": (176, 60, 66), "black": (60, 62, 68), "teal": (238, 240, 240)}

SKINS = {"black": (42, 42, 46), "teal": (34, 150, 150)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("hairbrush", variant)
    cushion_colour = CUSHION_COLOURS[variant]
    outline = solids.circle(1.0, 40) * (0.046, 0.03)
    head = lofts.levelled(outline, [(0, 0.86), (0.004, 0.98), (0.008, 1.0), (0.012, 0.96)])
    cushion = lofts.levelled(outline, [(0.0115, 0.85), (0.0145, 0.8), (0.016, 0.66), (0.0164, 0.4)])
    x = np.linspace(0.0415, 0.14, 16)
    scale = np.interp(x, [0.0415, 0.06, 0.095, 0.13, 0.14], [0.62, 0.72, 1.0, 0.9, 0.45])
    path = np.stack([x, np.zeros(16), np.interp(x, [0.0415, 0.08, 0.14], [0.0075, 0.0098, 0.0098])], axis=1)
    bar = solids.sweep(path, solids.circle(1.0, 20) * (0.0112, 0.0098), scale)
    bristles, tips = [], []
    for row, y in enumerate(np.linspace(-0.019, 0.019, 7)):
        for at in np.linspace(-0.033, 0.033, 11) + 0.0016 * (row % 2):
            if (at / 0.038) ** 2 + (y / 0.023) ** 2 < 1:
                bristles.append(solids.box((0.0011, 0.0011, 0.0135), (at, y, 0.015)))
                tips.append(solids.box((0.0021, 0.0021, 0.0021), (at, y, 0.0278)))
    wood = materials.wood(rng, materials.BEECH) if variant == "wood" else None
    skin = wood if wood is not None else materials.plastic(rng, SKINS[variant])
    parts = [
        paint(solids.union(head, bar), skin, tiled(0.12), roughness=0.5 if wood is not None else 0.3),
        paint(cushion, materials.plastic(rng, cushion_colour), tiled(0.05), roughness=0.8),
        paint(solids.union(*bristles), materials.plastic(rng, (52, 44, 42)), tiled(0.05), roughness=0.7),
        paint(solids.union(*tips), materials.plastic(rng, (228, 200, 150)), tiled(0.05), roughness=0.6),
    ]
    half = x > 0.085
    foot = [(at, y, z) for at in (0.04, 0.132) for y in (-0.005, 0.005) for z in (0.0, 0.003)]
    hulls = [
        lofts.levelled_hull(outline, [(0, 0.86), (0.004, 0.97), (0.008, 0.985), (0.012, 0.95)]),
        lofts.levelled_hull(outline, [(0.0115, 0.85), (0.016, 0.7)]),
        pieces.hull(*[solid.vertices for solid in (*bristles, *tips)]),
        pieces.coarse(bar.vertices[bar.vertices[:, 0] <= x[half][0] + 1e-6]),
        pieces.coarse(bar.vertices[bar.vertices[:, 0] >= x[~half][-1] - 1e-6]),
        pieces.hull(foot),
    ]
    return BuiltObject(parts, hulls, mass=0.08, friction=0.7)
