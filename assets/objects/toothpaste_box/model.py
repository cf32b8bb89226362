"""The closed carton of a tube of toothpaste, lying along x."""

from __future__ import annotations

from assets.textures import packaging
from vcage.objects.modelling import prints, solids
from vcage.objects.modelling.mappings import six_sides
from vcage.objects.modelling.parts import BuiltObject, paint

VARIANTS = {
    "red": ((204, 34, 42), (250, 246, 240), "DENTO"),
    "mint": ((22, 146, 128), (244, 250, 246), "MINTY"),
    "blue": ((28, 84, 172), (244, 248, 252), "AQUAFRESCA"),
}
"""Variant → accent, second, words."""


def build(variant: str) -> BuiltObject:
    accent, second, words = VARIANTS[variant]
    size = (0.165, 0.048, 0.038)
    face = packaging.label((512, 144), accent, [(words, 0.42, 0.42, 0.36, second)], places=(0.36,))
    face = packaging.polygon(face, [(0.68, 0), (1, 0), (1, 1), (0.58, 1)], second)
    face = packaging.polygon(face, [(0.65, 0), (0.67, 0), (0.57, 1), (0.55, 1)], second)
    face = packaging.fitted(face, "toothpaste", (0.34, 0.78), (0.3, 0.2), second)
    face = packaging.fitted(face, "75 ml", (0.9, 0.8), (0.1, 0.14), accent)
    for x, tone in ((0.74, 0.8), (0.8, 1.0), (0.86, 1.2)):
        shade = tuple(int(min(255, c * tone)) for c in accent)
        face = packaging.stroke(face, [(x - 0.02, 0.6), (x, 0.3), (x + 0.03, 0.55)], 0.08, shade)
    end = packaging.fitted(prints.canvas(96, 96, second), words[:5], (0.5, 0.5), (0.8, 0.3), accent)
    sides = {"front": face, "back": face, "top": face, "bottom": face, "left": end, "right": end}
    box = solids.rounded_box(size, 0.0012, steps=2)
    picture = prints.atlas(sides, accent, (512, 144))
    return BuiltObject([paint(box, picture, six_sides(), roughness=0.45)], [solids.box(size)], mass=0.12, friction=0.6)
