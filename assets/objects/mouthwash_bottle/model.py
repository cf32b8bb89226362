"""A flat bottle of coloured liquid with a ribbed measuring cap."""

from __future__ import annotations

from assets.textures import packaging
from vcage.objects.modelling import lofts, pieces, prints, solids
from vcage.objects.modelling.mappings import around, six_sides
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "blue": ((92, 170, 220), (24, 96, 176), "ARCTIC"),
    "green": ((120, 206, 150), (20, 128, 86), "SPEARMINT"),
}
"""Variant → liquid, deep, words."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("mouthwash_bottle", variant)
    liquid, deep, words = VARIANTS[variant]
    outline = solids.rounded_rectangle((0.068, 0.044), 0.014, 6)
    levels = [(0, 0.95), (0.003, 1), (0.098, 1), (0.11, 0.88, 0.9), (0.119, 0.6, 0.74), (0.122, 0.52, 0.72)]
    glass = packaging.frosted(rng, deep, liquid)
    glass = prints.rectangle(glass, (0, 0), (1, 0.13), tuple(int(0.5 * c + 0.5 * 250) for c in liquid))
    front = packaging.label((320, 320), packaging.WHITE, [(words, 0.2, 0.8, 0.14, deep)], [(0.32, 0.72, deep)], (0.5,))
    front = packaging.fitted(front, "MOUTH", (0.5, 0.44), (0.62, 0.14), packaging.WHITE)
    front = packaging.fitted(front, "WASH", (0.5, 0.61), (0.5, 0.14), packaging.WHITE)
    front = packaging.fitted(front, "fresh breath  500 ml", (0.5, 0.84), (0.7, 0.08), deep)
    plate = [
        solids.box((0.046, 0.0006, 0.062), (0, sign * 0.0221, 0.018)) for sign in (-1, 1)
    ]  # the labels, front and back
    cap = [(0, 0.1215), (0.019, 0.1215), (0.019, 0.123), (0.0185, 0.156), (0.0165, 0.158), (0, 0.158)]
    rim = tuple(int(0.82 * c) for c in deep)
    parts = [
        paint(lofts.levelled(outline, levels), glass, around(), roughness=0.12),
        paint(
            solids.union(*plate),
            prints.atlas({"front": front, "back": front}, packaging.WHITE, (320, 320)),
            six_sides(),
        ),
        paint(solids.revolved(cap, 40), packaging.striped([deep, rim], 60), around(), roughness=0.4),
    ]
    hulls = [lofts.levelled_hull(outline, levels), pieces.stack([(0.019, 0.1215), (0.0185, 0.157), (0.0165, 0.158)])]
    return BuiltObject(parts, hulls, mass=0.35, friction=0.7)
