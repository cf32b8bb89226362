"""A tin can with a paper label and a ribbed lid."""

from __future__ import annotations

from assets.textures.labels import coded
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "tomato": ("TOMATOES", (188, 36, 32), (236, 90, 60)),
    "corn": ("SWEET CORN", (34, 110, 62), (246, 206, 60)),
}
"""Variant → words, ground, spot."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("can", variant)
    words, ground, spot = VARIANTS[variant]
    radius, height = 0.0325, 0.09
    rim = [(0, 0.0012), (radius - 0.002, 0.0012), (radius - 0.002, 0), (radius, 0), (radius, 0.003)]
    rim += [(radius - 0.0008, 0.0045), (radius - 0.0008, height - 0.0045), (radius, height - 0.003), (radius, height)]
    rim += [(radius - 0.002, height), (radius - 0.0026, height - 0.003), (0, height - 0.003)]
    tin = solids.revolved(rim, 36)
    paper = solids.revolved(
        [(0.02, 0.008), (radius - 0.0002, 0.008), (radius - 0.0002, height - 0.008), (0.02, height - 0.008)], 36
    )
    label = prints.canvas(1280, 480, ground)
    label = prints.rectangle(label, (0, 0.08), (1, 0.11), (246, 226, 170))
    label = prints.rectangle(label, (0, 0.89), (1, 0.92), (246, 226, 170))
    for x in (0.0, 0.5, 1.0):
        label = prints.disc(label, (x, 0.64), 0.15, spot)
        label = prints.text(label, words, (x, 0.32), 0.15 if variant == "tomato" else 0.12, (250, 244, 228))
    label = coded(label, ("can", variant), (0.75, 0.5))
    parts = [
        paint(tin, materials.brushed(rng), tiled(0.05), roughness=0.35, metallic=0.4),
        paint(paper, label, around(), roughness=0.6),
    ]
    return BuiltObject(parts, [pieces.stack([(radius, 0), (radius, height)])], mass=0.4, friction=0.6)
