"""An oval stick with a domed cap and a dial at its foot."""

from __future__ import annotations

from assets.textures import packaging
from vcage.objects.modelling import lofts, materials, pieces, solids
from vcage.objects.modelling.mappings import around, from_above
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {"navy": ((32, 48, 86), (176, 184, 194)), "pink": ((244, 244, 242), (238, 150, 178))}
"""Variant → ground, lid."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("deodorant_stick", variant)
    ground, lid = VARIANTS[variant]
    ink = (232, 240, 248) if variant == "navy" else (196, 80, 124)
    outline = solids.circle(1.0, 40) * (0.03, 0.0165)
    foot = solids.revolved([(0, 0), (0.0145, 0), (0.0145, 0.008), (0, 0.008)], 36)
    body = [(0.006, 0.93), (0.0075, 1), (0.064, 1)]
    cap = [(0.0645, 0.985), (0.066, 1.0), (0.1, 0.985), (0.108, 0.92), (0.112, 0.74), (0.113, 0.5)]
    lines = [("NORDA" if variant == "navy" else "BLOOM", 0.36, 0.3, 0.26, ink), ("deodorant", 0.66, 0.26, 0.15, ink)]
    label = packaging.label((512, 224), ground, lines, [(0.84, 0.88, ink)])
    parts = [
        paint(foot, packaging.striped([(70, 72, 78), (50, 52, 58)], 44), around(), roughness=0.5),
        paint(lofts.levelled(outline, body), label, around(), roughness=0.35),
        paint(lofts.levelled(outline, cap), materials.plastic(rng, lid), from_above(), roughness=0.25),
    ]
    dial = pieces.stack([(0.0145, 0), (0.0145, 0.0075)])
    hulls = [dial, lofts.levelled_hull(outline, body), lofts.levelled_hull(outline, cap)]
    return BuiltObject(parts, hulls, mass=0.1, friction=0.6)
