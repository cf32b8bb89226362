"""A tube that stands on its wide cap; the folded end is on top, along x."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import lofts, materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, six_sides, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "mint": ((28, 150, 130), "MINTY"),
    "red": ((206, 38, 44), "DENTO"),
    "blue": ((30, 86, 176), "AQUAFRESCA"),
}
"""Variant → accent, words."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("toothpaste_tube", variant)
    accent, words = VARIANTS[variant]
    shoulder, fold, top = 0.026, 0.128, 0.14
    outline = solids.circle(1.0, 40)
    share = np.linspace(0, 1, 9)
    levels: list[lofts.Level] = [(0.019, 0.009, 0.009)]
    levels += [(shoulder + (fold - shoulder) * s, 0.0175 + 0.0085 * s, 0.0175 * np.sqrt(1 - s) + 0.0016) for s in share]
    levels += [(top, 0.026, 0.0016)]
    cap = [(0, 0), (0.0165, 0), (0.018, 0.0015), (0.017, 0.021), (0.0155, 0.022), (0, 0.022)]
    face = packaging.label(
        (224, 512), packaging.WHITE, [], [(0.0, 0.08, accent), (0.76, 1.0, accent), (0.72, 0.74, accent)]
    )
    face = packaging.fitted(face, words, (0.5, 0.42), (0.5, 0.3), accent, upright=True)
    face = packaging.fitted(face, "toothpaste", (0.68, 0.42), (0.34, 0.12), (60, 70, 84), upright=True)
    side = packaging.label(
        (64, 512), packaging.WHITE, [], [(0.0, 0.08, accent), (0.76, 1.0, accent), (0.72, 0.74, accent)]
    )
    picture = prints.atlas({"front": face, "back": face, "left": side, "right": side}, accent, (224, 512))
    ribs = packaging.striped([(232, 232, 230), (206, 206, 204)], 72)
    parts = [
        paint(lofts.levelled(outline, levels), picture, six_sides(), roughness=0.3),
        paint(solids.revolved(cap, 40), ribs, around(), roughness=0.4),
        paint(
            solids.box((0.05, 0.0036, 0.0006), (0, 0, top - 0.004)),
            materials.plastic(rng, packaging.WHITE),
            tiled(0.05),
        ),  # the seam of the folded end
    ]
    convex = [levels[:5], levels[4:8], levels[7:]]  # the whole narrows unevenly
    hulls = [pieces.stack([(0.0165, 0), (0.018, 0.0015), (0.017, 0.022)])]
    hulls += [lofts.levelled_hull(outline, part) for part in convex]
    return BuiltObject(parts, hulls, mass=0.11, friction=0.7)
