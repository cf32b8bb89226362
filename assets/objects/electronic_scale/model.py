"""A shop scale: a steel platform of 0.18 × 0.15 m behind a console with display and keys."""

from __future__ import annotations

import numpy as np

from assets.shapes.sloped_plate import sloped_plate
from assets.textures import labels, till_faces
from vcage.objects.modelling import materials, prints, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

GREEN_GLASS, GREEN_INK = (176, 196, 156), (36, 46, 36)
"""Ground and segments of a liquid-crystal display."""

VARIANTS = {
    "white": ((232, 232, 228), (50, 54, 60)),
    "black": ((44, 46, 50), (230, 230, 226)),
    "blue": ((52, 98, 156), (240, 240, 236)),
}
"""Variant → colour, ink."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("electronic_scale", variant)
    colour, ink = VARIANTS[variant]
    width, front, gap, edge, back = 0.18, -0.115, -0.063, -0.037, 0.115
    base = solids.rounded_box((width - 0.004, back - front, 0.018), 0.005, (0, (front + back) / 2, 0.0))
    low, high = (front + 0.002, 0.026), (gap - 0.01, 0.046)
    outline = [(front + 0.002, 0.01), (gap, 0.01), (gap, 0.044), (gap - 0.003, 0.046), high, low]
    console = solids.moved(solids.prism(outline, width, -width / 2), turn=120, axis=(1, 1, 1))  # y, z, x → x, y, z
    neck = solids.box((0.11, 0.09, 0.015), (0, (edge + back) / 2, 0.014))
    plate = solids.rounded_box((width, back - edge, 0.007), 0.003, (0, (edge + back) / 2, 0.0275), steps=4)
    unit = prints.text(prints.canvas(64, 144, GREEN_GLASS), "kg", (0.42, 0.68), 0.26, GREEN_INK)
    reading = labels.display("0.00", (320, 144), GREEN_INK, GREEN_GLASS, cells=4)
    screen = till_faces.framed(np.hstack([reading, unit]), (28, 30, 34))
    parts = [
        paint(solids.union(base, console), materials.plastic(rng, colour), tiled(0.1), roughness=0.5),
        paint(neck, materials.plastic(rng, (60, 62, 66)), tiled(0.1), roughness=0.6),
        paint(plate, materials.brushed(rng, (204, 206, 210)), tiled(0.12), roughness=0.3, metallic=0.4),
        paint(sloped_plate((0.084, 0.036, 0.002), low, high, -0.028), screen, from_above(), roughness=0.2),
    ]
    for x, words, ground in ((0.036, "ON", (70, 160, 90)), (0.067, "TARE", (226, 130, 40))):
        cap = prints.text(prints.canvas(96, 72, ground), words, (0.5, 0.5), 0.36, (255, 255, 250))
        key = sloped_plate((0.024, 0.018, 0.004), low, high, x, 0.35, radius=0.0015)
        parts.append(paint(key, cap, from_above(), roughness=0.5))
        dark = prints.text(prints.canvas(96, 40, colour), "MAX 3 kg" if x < 0.05 else "d=1 g", (0.5, 0.5), 0.5, ink)
        parts.append(paint(sloped_plate((0.026, 0.01, 0.0012), low, high, x, 0.8), dark, from_above()))
    hulls = [base.convex_hull, console.convex_hull, neck, solids.box(plate.extents, (0, (edge + back) / 2, 0.0275))]
    return BuiltObject(parts, hulls, mass=0.5, friction=0.7)
