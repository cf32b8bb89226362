"""A round bottle with a pump whose spout looks to the front."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "white": ((238, 236, 230), (70, 74, 82), (198, 200, 204)),
    "amber": ((128, 70, 26), (246, 236, 214), (44, 44, 46)),
    "grey": ((128, 132, 136), (240, 240, 236), (212, 178, 110)),
}
"""Variant → ground, ink, metal."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("soap_dispenser", variant)
    ground, ink, metal = VARIANTS[variant]
    radius, top = 0.035, 0.142
    body = [(0, 0), (radius - 0.002, 0), (radius, 0.002), (radius, 0.078)]
    body = np.concatenate([body, solids.arc((0.0145, 0.078), (radius - 0.0145, 0.016), 10, 90, 7), [(0, 0.094)]])
    collar = [(0, 0.0935), (0.0145, 0.0935), (0.0155, 0.0945), (0.0155, 0.115), (0.0145, 0.116), (0, 0.116)]
    stem = solids.revolved([(0, 0.115), (0.0045, 0.115), (0.0045, 0.132), (0, 0.132)], 20)
    head = solids.revolved([(0, 0.13), (0.011, 0.13), (0.012, 0.132), (0.011, top - 0.001), (0.009, top), (0, top)], 28)
    spout = solids.rounded_box((0.009, 0.04, 0.008), 0.003, (0, -0.024, 0.1315))
    tip = solids.box((0.006, 0.006, 0.008), (0, -0.04, 0.1255))
    label = packaging.label(
        (640, 288), ground, [("HAND SOAP", 0.53, 0.2, 0.12, ink), ("fig & cedar", 0.66, 0.15, 0.08, ink)]
    )
    for x in (0.0, 0.5, 1.0):
        frame = [(x - 0.12, 0.4), (x + 0.12, 0.4), (x + 0.12, 0.76), (x - 0.12, 0.76)]
        label = packaging.stroke(label, frame, 0.012, ink, closed=True)
    steel = materials.brushed(rng, metal)
    parts = [
        paint(solids.revolved(body, 44), label, around(), roughness=0.25),
        paint(solids.revolved(collar, 36), steel, tiled(0.02, along=2), roughness=0.3, metallic=0.4),
        paint(solids.union(stem, head, spout, tip), steel, tiled(0.05), roughness=0.3, metallic=0.4),
    ]
    hulls = [
        pieces.stack([(radius, 0), (radius, 0.08), (0.029, 0.0895), (0.0145, 0.094)]),
        pieces.stack([(0.0155, 0.0935), (0.0155, 0.116)]),
        pieces.stack([(0.0045, 0.115), (0.0045, 0.132)], 8),
        pieces.stack([(0.012, 0.13), (0.012, top)]),
        spout.convex_hull,
        tip,
    ]
    return BuiltObject(parts, hulls, mass=0.3, friction=0.7)
