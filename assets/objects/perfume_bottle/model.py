"""A flat glass flask with a metal collar and a tall cap."""

from __future__ import annotations

from assets.textures import packaging
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, from_front, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "rose": ((236, 150, 160), (252, 226, 226), (216, 180, 110)),
    "amber": ((206, 132, 40), (248, 214, 140), (36, 34, 36)),
    "blue": ((54, 110, 186), (196, 222, 244), (206, 208, 212)),
}
"""Variant → low, high, lid."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("perfume_bottle", variant)
    low, high, lid = VARIANTS[variant]
    size, neck, top = (0.056, 0.03, 0.068), 0.074, 0.104
    glass = solids.rounded_box(size, 0.006, steps=4)
    picture = packaging.frosted(rng, high, low)
    picture = prints.rectangle(picture, (0, 0), (1, 0.2), tuple(int(0.35 * c + 165) for c in high))
    ink = tuple(int(0.35 * c) for c in low)
    plate = solids.box((0.032, 0.0008, 0.026), (0, -size[1] / 2 - 0.0001, 0.02))
    face = packaging.label((256, 208), (250, 246, 236), [("ODETTE", 0.42, 0.8, 0.24, ink)], places=(0.5,))
    face = packaging.fitted(face, "eau de parfum", (0.5, 0.68), (0.66, 0.12), ink)
    edge = [(0.03, 0.04), (0.97, 0.04), (0.97, 0.96), (0.03, 0.96)]
    face = packaging.stroke(face, edge, 0.02, tuple(lid), closed=True)
    collar = [(0, 0.067), (0.0105, 0.067), (0.0105, neck), (0, neck)]
    cap = [(0, neck), (0.0118, neck), (0.0125, neck + 0.001), (0.0125, top - 0.002), (0.011, top), (0, top)]
    parts = [
        paint(glass, picture, around(), roughness=0.08),
        paint(plate, face, from_front(), roughness=0.5),
        paint(solids.revolved(collar, 32), materials.brushed(rng), tiled(0.05), roughness=0.25, metallic=0.5),
        paint(solids.revolved(cap, 36), materials.plastic(rng, lid), tiled(0.05), roughness=0.2, metallic=0.3),
    ]
    hulls = [
        solids.rounded_box(size, 0.006, steps=2),
        pieces.stack([(0.0105, 0.067), (0.0105, neck)]),
        pieces.stack([(0.0125, neck), (0.0125, top - 0.001), (0.011, top)]),
    ]
    return BuiltObject(parts, hulls, mass=0.16, friction=0.6)
