"""A tall oval bottle with an oval flip cap, wide face to the front."""

from __future__ import annotations

from assets.textures import packaging
from vcage.objects.modelling import lofts, materials, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "blue": ((44, 112, 186), (196, 226, 246)),
    "green": ((70, 142, 82), (226, 240, 190)),
    "purple": ((118, 74, 150), (238, 206, 236)),
}
"""Variant → ground, accent."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("shampoo_bottle", variant)
    ground, accent = VARIANTS[variant]
    height, shoulder = 0.168, 0.128
    outline, lid = solids.circle(1.0, 40) * (0.032, 0.0215), solids.circle(1.0, 32) * (0.0205, 0.0155)
    levels = [(0, 0.93), (0.003, 1), (shoulder - 0.032, 1), (shoulder - 0.012, 0.92), (shoulder - 0.003, 0.74)]
    levels += [(shoulder, 0.64)]
    cap = [
        (shoulder - 0.0005, 0.97),
        (shoulder + 0.002, 1),
        (height - 0.004, 1),
        (height - 0.001, 0.94),
        (height, 0.85),
    ]
    lines = [("SHAMPOO", 0.53, 0.34, 0.1, packaging.WHITE), ("LUMINA", 0.38, 0.24, 0.09, accent)]
    lines += [("daily care", 0.66, 0.2, 0.06, accent), ("300 ml", 0.88, 0.1, 0.04, accent)]
    label = packaging.label((768, 512), ground, lines, [(0.74, 0.765, accent), (0.79, 0.8, accent)])
    parts = [
        paint(lofts.levelled(outline, levels), label, around(), roughness=0.3),
        paint(lofts.levelled(lid, cap), materials.plastic(rng, packaging.WHITE), tiled(0.05), roughness=0.35),
        paint(
            solids.box((0.013, 0.0008, 0.004), (0, -0.0155, height - 0.012)),
            materials.plastic(rng, (190, 190, 188)),
            tiled(0.05),
        ),
    ]
    hulls = [lofts.levelled_hull(outline, levels), lofts.levelled_hull(lid, cap)]
    return BuiltObject(parts, hulls, mass=0.3, friction=0.6)
