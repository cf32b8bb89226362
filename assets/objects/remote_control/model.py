"""A television remote control along y."""

from __future__ import annotations

from vcage.objects.modelling import pieces, prints, solids
from vcage.objects.modelling.mappings import from_above
from vcage.objects.modelling.parts import BuiltObject, paint

COLOURS = {"black": (38, 38, 42), "white": (232, 232, 230)}


def build(variant: str) -> BuiltObject:
    colour = COLOURS[variant]
    body = solids.rounded_box((0.044, 0.15, 0.021), 0.007)
    ink = (200, 200, 204) if variant == "black" else (70, 72, 78)
    face = prints.canvas(192, 640, colour)
    face = prints.disc(face, (0.25, 0.075), 0.022, (214, 40, 44))
    for i in range(12):
        face = prints.disc(face, (0.25 + 0.25 * (i % 3), 0.17 + 0.065 * (i // 3)), 0.02, ink)
    face = prints.disc(face, (0.5, 0.56), 0.105, ink)
    face = prints.disc(face, (0.5, 0.56), 0.05, colour)
    for i, light in enumerate([(200, 50, 50), (60, 160, 80), (230, 200, 60), (60, 100, 200)]):
        face = prints.rectangle(face, (0.14 + 0.19 * i, 0.72), (0.28 + 0.19 * i, 0.74), light)
    for i in range(6):
        face = prints.disc(face, (0.25 + 0.25 * (i % 3), 0.81 + 0.06 * (i // 3)), 0.016, ink)
    return BuiltObject([paint(body, face, from_above(), roughness=0.45)], [pieces.coarse(body.vertices, 90)], 0.1, 0.7)
