"""A closed hard case for glasses, lying along x, the seam in front."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import lofts, materials, prints, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"brown": (112, 66, 38), "navy": (36, 50, 86), "red": (156, 36, 44)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("glasses_case", variant)
    colour = COLOURS[variant]
    wide, deep, tall, seam = 0.16, 0.062, 0.042, 0.022
    outline = solids.rounded_rectangle((wide, deep), 0.026, 9)
    lower = [(0, 0.9, 0.8), (0.002, 0.945, 0.88), (0.008, 0.985, 0.965), (0.015, 1.0, 1.0), (seam - 0.0006, 1.0, 1.0)]
    upper = [(seam + 0.0006, 1.0, 1.0), (0.028, 0.997, 0.99), (0.034, 0.98, 0.94), (0.039, 0.94, 0.84)]
    upper += [(tall - 0.0005, 0.87, 0.66), (tall, 0.8, 0.45)]
    skin = materials.felt(rng, colour, 256)
    skin = (0.55 * skin + 0.45 * np.asarray(colour)).astype(np.uint8)
    lid = np.tile(skin, (1, 2, 1))
    gold = (214, 180, 108)
    edge = solids.rounded_rectangle((0.86, 0.66), 0.16, 6) + 0.5
    lid = packaging.stroke(
        lid, [tuple(p) for p in edge], 0.012, tuple(int(min(255, 1.5 * c)) for c in colour), closed=True
    )
    for x in (0.455, 0.545):
        lid = prints.disc(prints.disc(lid, (x, 0.5), 0.075, gold), (x, 0.5), 0.055, colour)
    lid = packaging.stroke(lid, [(0.485, 0.47), (0.515, 0.47)], 0.022, gold)
    lining = lofts.levelled(outline, [(seam - 0.001, 0.985, 0.97), (seam + 0.001, 0.985, 0.97)])
    clasp = solids.rounded_box((0.022, 0.004, 0.012), 0.0016, (0, -deep / 2 + 0.0008, seam - 0.005))
    parts = [
        paint(lofts.levelled(outline, lower), skin, tiled(0.08), roughness=0.6),
        paint(lofts.levelled(outline, upper), lid, from_above(), roughness=0.6),
        paint(lining, materials.plastic(rng, (30, 28, 28)), tiled(0.05), roughness=0.9),
        paint(clasp, materials.brushed(rng, gold), tiled(0.05), roughness=0.3, metallic=0.4),
    ]
    few = solids.rounded_rectangle((wide, deep), 0.026, 8)
    few = np.repeat(few, 2, axis=0)
    hull = lofts.levelled_hull(few, [lower[0], lower[1], lower[3], upper[0], upper[2], upper[4]])
    return BuiltObject(parts, [hull, clasp.convex_hull], mass=0.13, friction=0.7)
