"""A closed cardboard box of tea bags."""

from __future__ import annotations

from assets.textures.labels import coded
from vcage.objects.modelling import materials, prints, solids
from vcage.objects.modelling.mappings import six_sides
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"green": (70, 124, 70), "black": (120, 40, 36)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("tea_box", variant)
    ground, words = COLOURS[variant], variant.upper()
    size = (0.1, 0.062, 0.068)
    front = materials.plastic(rng, ground, 256)
    front = prints.rectangle(front, (0.08, 0.14), (0.92, 0.86), (244, 232, 204))
    front = prints.text(front, words, (0.5, 0.35), 0.17, tuple(int(0.7 * c) for c in ground))
    front = prints.text(front, "TEA", (0.5, 0.62), 0.26, tuple(int(0.7 * c) for c in ground))
    top = prints.text(materials.plastic(rng, ground, 256), "TEA", (0.5, 0.5), 0.34, (244, 232, 204))
    cell = (384, 384)
    end = coded(prints.canvas(*cell, ground), ("tea_box", variant), (0.5, 0.55))
    picture = prints.atlas({"front": front, "back": front, "top": top, "right": end}, ground, cell)
    box = solids.rounded_box(size, 0.0012, steps=2)
    return BuiltObject([paint(box, picture, six_sides(), roughness=0.6)], [solids.box(size)], mass=0.12, friction=0.6)
