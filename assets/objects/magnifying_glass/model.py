"""A reading glass that lies flat, lens to the left and a thick handle to the right along x."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import lofts, materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

RIM_COLOURS = {"brass": (206, 164, 82), "black": (50, 50, 54)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("magnifying_glass", variant)
    rim_colour = RIM_COLOURS[variant]
    radius, thick, middle = 0.038, 0.011, (-0.052, 0.0, 0.0)
    frame = [
        (radius - 0.005, 0),
        (radius - 0.001, 0),
        (radius, 0.0015),
        (radius, thick - 0.0015),
        (radius - 0.001, thick),
    ]
    rim = solids.moved(solids.revolved([*frame, (radius - 0.005, thick)], 56), middle)
    glass_profile = [(0, 0.0034), (radius - 0.0045, 0.0042), (radius - 0.0045, 0.0066), (0.02, 0.0078), (0, 0.0082)]
    glass = solids.moved(solids.revolved(glass_profile, 48), middle)
    lens = prints.canvas(256, 256, (188, 214, 226))
    lens = prints.disc(lens, (0.5, 0.5), 0.4, (204, 226, 236))
    lens = packaging.stroke(lens, [(0.24, 0.46), (0.46, 0.24)], 0.06, (246, 251, 253))
    lens = packaging.stroke(lens, [(0.3, 0.6), (0.6, 0.3)], 0.03, (238, 247, 251))
    axis = 0.0104
    neck = lofts.rod(0.0046, -0.0165, 0.004, 0.0068, 20)
    x = np.array([0.0, 0.003, 0.012, 0.04, 0.07, 0.08, 0.084])
    scale = np.array([0.7, 0.8, 0.9, 1.0, 0.98, 0.85, 0.6])
    ring = solids.circle(0.0112, 28)
    ring[:, 1] = np.maximum(ring[:, 1], -axis)
    stations = [np.column_stack([np.full(28, at), ring * s + (0, axis)]) for at, s in zip(x, scale, strict=True)]
    handle = solids.closed_rings(stations)
    steel = materials.brushed(rng, rim_colour)
    grip = materials.wood(rng, materials.WALNUT) if variant == "brass" else materials.plastic(rng, (36, 36, 40))
    parts = [
        paint(rim, steel, tiled(0.05), roughness=0.3, metallic=0.4),
        paint(neck, steel, tiled(0.05), roughness=0.3, metallic=0.4),
        paint(glass, lens, from_above(), roughness=0.05),
        paint(handle, grip, tiled(0.1), roughness=0.45),
    ]
    profile = [(radius - 0.005, 0), (radius, 0), (radius, thick), (radius - 0.005, thick)]
    hulls = pieces.ring(profile, 16, middle[:2])
    hulls += [
        pieces.stack([(radius - 0.005, 0.0036), (radius - 0.005, 0.0064), (0.02, 0.008)], 16, middle[:2]),
        pieces.hull(neck.vertices[::2]),
        pieces.hull(handle.vertices[::2]),
    ]
    return BuiltObject(parts, hulls, mass=0.12, friction=0.7)
