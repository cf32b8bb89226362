"""A small car that looks along -x: body, cabin, four wheels that do not turn."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"red": (206, 36, 40), "blue": (34, 96, 190), "yellow": (244, 196, 36)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("toy_car", variant)
    colour = COLOURS[variant]
    length, width = 0.096, 0.044
    body = solids.rounded_box((length, width - 0.004, 0.018), 0.007, (0, 0, 0.008))
    cabin = solids.moved(_cabin_prism(width - 0.01), (0.006, 0, 0.024))
    glass = solids.moved(_cabin_prism(width - 0.0085, 0.82), (0.006, 0, 0.0255))
    roof = solids.rounded_box((0.026, width - 0.0085, 0.003), 0.0014, (0.006, 0, 0.0385))
    wheels, hubs = [], []
    for x in (-0.029, 0.029):
        for y in (-1, 1):
            wheel = solids.revolved(
                [(0, 0), (0.010, 0), (0.0105, 0.001), (0.0105, 0.007), (0.009, 0.008), (0, 0.008)], 20
            )
            hub = solids.revolved([(0, 0.0075), (0.0055, 0.0075), (0.0045, 0.0086), (0, 0.0086)], 16)
            at = (x, y * (width / 2 - 0.008), 0.0105)
            wheels.append(solids.moved(wheel, at, turn=-90 * y, axis=(1, 0, 0)))
            hubs.append(solids.moved(hub, at, turn=-90 * y, axis=(1, 0, 0)))
    lamps = [
        solids.rounded_box((0.003, 0.008, 0.005), 0.0014, (-length / 2 + 0.0008, y, 0.015)) for y in (-0.012, 0.012)
    ]
    coat = materials.plastic(rng, colour)
    parts = [paint(solids.union(body, cabin), coat, tiled(0.05), roughness=0.25)]
    screens = solids.moved(_cabin_prism(width - 0.016, 1.02), (0.006, 0, 0.0236))
    parts.append(paint(solids.union(glass, screens), materials.plastic(rng, (44, 54, 66)), tiled(0.05), roughness=0.1))
    parts.append(paint(roof, coat, tiled(0.05), roughness=0.25))
    parts.append(paint(solids.union(*wheels), materials.plastic(rng, (30, 30, 32)), tiled(0.05), roughness=0.8))
    parts.append(paint(solids.union(*hubs), materials.brushed(rng), tiled(0.02), roughness=0.3, metallic=0.3))
    parts.append(paint(solids.union(*lamps), materials.plastic(rng, (252, 244, 200)), tiled(0.05), roughness=0.2))
    hulls = [pieces.coarse(body.vertices), pieces.hull(*[s.vertices for s in (cabin, glass, screens, roof)])]
    hulls += [pieces.coarse(wheel.vertices) for wheel in wheels]
    return BuiltObject(parts, hulls, mass=0.07, friction=0.8)


def _cabin_prism(width: float, scale: float = 1.0) -> solids.Solid:
    """A trapezoid seen from the side, standing at z = 0, along x."""
    outline = np.array([(-0.026, 0), (0.028, 0), (0.017, 0.016), (-0.013, 0.016)]) * scale
    upright = solids.moved(solids.prism(outline, width, -width / 2), turn=90, axis=(1, 0, 0))
    return upright
