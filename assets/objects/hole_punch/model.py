"""A two-hole punch with a broad lever that rises towards the front."""

from __future__ import annotations

from assets.textures import packaging
from vcage.objects.modelling import lofts, materials, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"black": (44, 44, 48), "red": (186, 34, 38), "blue": (34, 84, 160)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("hole_punch", variant)
    colour = COLOURS[variant]
    width = 0.1
    base = solids.rounded_box((width + 0.006, 0.088, 0.012), 0.004, steps=3)
    column = solids.box((width - 0.012, 0.024, 0.02), (0, 0.02, 0.01))
    profile = [(-0.034, 0.044), (-0.028, 0.04), (0.034, 0.022), (0.038, 0.027), (0.032, 0.04), (0.012, 0.051)]
    profile += [(-0.026, 0.056), (-0.034, 0.053)]
    lever = lofts.across(profile, width)
    pins = [
        solids.moved(solids.revolved([(0, 0.0115), (0.0045, 0.0115), (0.0045, 0.036), (0, 0.036)], 20), (x, 0.0, 0))
        for x in (-0.04, 0.04)
    ]
    scale = solids.box((width + 0.007, 0.007, 0.0012), (0, -0.03, 0.0115))
    marks = packaging.striped([(228, 228, 224), (70, 70, 74)], 42)
    pad = lofts.across(
        [(-0.03, 0.053), (0.006, 0.051), (0.006, 0.0535), (-0.0255, 0.0568), (-0.03, 0.0556)], width - 0.016
    )
    parts = [
        paint(solids.union(base, column), materials.plastic(rng, (60, 60, 64)), tiled(0.05), roughness=0.6),
        paint(lever, materials.plastic(rng, colour), tiled(0.05), roughness=0.3, crease=25),
        paint(pad, materials.plastic(rng, tuple(int(0.6 * c + 12) for c in colour)), tiled(0.05), roughness=0.7),
        paint(scale, marks, from_above(), roughness=0.5),
        paint(solids.union(*pins), materials.brushed(rng), tiled(0.05), roughness=0.25, metallic=0.5),
    ]
    hulls = [base.convex_hull, column, lever.convex_hull, pad.convex_hull, *[pin.convex_hull for pin in pins], scale]
    return BuiltObject(parts, hulls, mass=0.35, friction=0.7)
