"""A desk stapler along x, hinge to the right."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"black": (40, 40, 44), "red": (190, 36, 40)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("stapler", variant)
    colour = COLOURS[variant]
    base = solids.rounded_box((0.125, 0.038, 0.011), 0.005)
    outline = np.concatenate(
        [
            [(-0.06, 0.020), (0.02, 0.022), (0.054, 0.014)],
            solids.arc((0.048, 0.028), (0.012, 0.018), -50, 80, 7),
            solids.arc((-0.02, 0.030), (0.041, 0.0165), 90, 175, 7),
        ]
    )
    arm = solids.moved(solids.prism(outline, 0.026, -0.013), turn=90, axis=(1, 0, 0))
    hinge = solids.box((0.026, 0.03, 0.014), (0.044, 0, 0.006))  # below the pads of a tilted hand
    rail = solids.box((0.098, 0.016, 0.007), (-0.0125, 0, 0.0165))
    anvil = solids.box((0.018, 0.02, 0.001), (-0.05, 0, 0.0106))
    pad = solids.rounded_box((0.05, 0.018, 0.003), 0.0012, (-0.005, 0, 0.0452))
    parts = [
        paint(solids.union(base, hinge), materials.plastic(rng, (58, 58, 62)), tiled(0.05), roughness=0.5),
        paint(arm, materials.plastic(rng, colour), tiled(0.05), roughness=0.3, crease=30),
        paint(pad, materials.felt(rng, (120, 122, 128)), tiled(0.03), roughness=0.8),
        paint(solids.union(rail, anvil), materials.brushed(rng), tiled(0.05), roughness=0.3, metallic=0.4),
    ]
    hulls = [base.convex_hull, arm.convex_hull, hinge, rail, pad.convex_hull]
    return BuiltObject(parts, hulls, mass=0.2, friction=0.7)
