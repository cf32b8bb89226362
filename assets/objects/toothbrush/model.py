"""A chunky toothbrush that lies on its back along x, bristles up at the left end."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"blue": (40, 120, 200), "pink": (230, 90, 140)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("toothbrush", variant)
    colour = COLOURS[variant]
    x = np.linspace(-0.04, 0.085, 20)
    scale = np.interp(x, [-0.04, -0.01, 0.02, 0.06, 0.08, 0.085], [0.42, 0.45, 0.85, 1, 0.85, 0.5])
    half_width, half_height = 0.0078, 0.0085
    path = np.stack([x, np.zeros(20), half_height * scale], axis=1)
    handle = solids.sweep(path, solids.circle(1.0, 18) * (half_width, half_height), scale)
    head = solids.rounded_box((0.034, 0.0125, 0.0055), 0.0025, (-0.05, 0, 0.0005))
    grip = solids.rounded_box((0.05, 0.0095, 0.003), 0.0014, (0.048, 0, 2 * half_height * 0.97 - 0.0026))
    tufts = []
    for i, at in enumerate(np.linspace(-0.063, -0.037, 6)):
        for y in (-0.0036, 0, 0.0036):
            tufts.append(solids.box((0.0036, 0.003, 0.0105 + 0.001 * (i % 2)), (at, y, 0.005)))
    parts = [
        paint(solids.union(handle, head), materials.plastic(rng, colour), tiled(0.05), roughness=0.35),
        paint(grip, materials.plastic(rng, (240, 240, 240)), tiled(0.05), roughness=0.6),
        paint(solids.union(*tufts), materials.page_edges(rng, (238, 244, 250), 64), tiled(0.01), roughness=0.9),
    ]
    bristles = pieces.hull(*[tuft.vertices for tuft in tufts])
    foot = pieces.hull(*[[(at, y, z) for at in (-0.06, 0.08) for z in (0, 0.004)] for y in (-0.004, 0.004)])
    middle = pieces.coarse(handle.vertices[(handle.vertices[:, 0] > -0.002)])
    neck = pieces.coarse(handle.vertices[(handle.vertices[:, 0] < 0.006)])
    return BuiltObject(
        parts, [middle, neck, head.convex_hull, bristles, foot, grip.convex_hull], mass=0.02, friction=0.7
    )
