"""A frying pan of 0.176 m with a long raised handle to the right."""

from __future__ import annotations

import numpy as np

from assets.shapes.cookware import dark_part, steel_part
from assets.textures.kitchen import from_centre
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.noise import Colour, noise, over, shaded
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"black": (44, 44, 46), "copper": (186, 104, 62), "green": (58, 104, 84)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("frying_pan", variant)
    top, foot, height, floor = 0.088, 0.068, 0.04, 0.0055
    outer = [(0, 0), (foot - 0.002, 0), (foot, 0.001), (top - 0.001, height - 0.002), (top, height - 0.001)]
    outer += [(top - 0.001, height), (top - 0.0035, height), (foot + 0.0005, floor + 0.004)]
    outer += [(foot - 0.0025, floor + 0.001), (foot - 0.006, floor), (0, floor)]
    outside, inside = solids.split_by_facing(solids.revolved(outer, 56))
    colour = COLOURS[variant]
    shell = materials.brushed(rng, colour)
    coat = _nonstick(rng, (58, 58, 60) if variant != "copper" else (196, 190, 182))
    parts = [
        paint(outside, shell, tiled(0.1), roughness=0.4, metallic=0.2),
        paint(inside, coat, from_above(), roughness=0.45),
    ]
    hulls = [pieces.stack([(foot - 0.002, 0), (foot, 0.001), (foot + 0.002, floor)])]
    hulls += pieces.ring([(foot - 0.0005, floor), (foot + 0.001, 0.002), (top, height - 0.001), (top - 0.0035, height)])
    x = np.array([0.083, 0.092, 0.105, 0.125, 0.16, 0.2, 0.222, 0.229])
    z = np.array([0.031, 0.0345, 0.039, 0.0425, 0.046, 0.0475, 0.047, 0.0465])
    width = np.array([0.62, 0.62, 0.8, 0.92, 1.0, 1.08, 0.95, 0.55])
    path = np.stack([x, np.zeros(8), z], axis=1)
    section = solids.circle(1.0, 20) * (0.0125, 0.0105)
    handle = solids.sweep(path, section, np.stack([width, np.interp(x, [0.083, 0.1, 0.22], [0.7, 1, 0.8])], axis=1))
    hanger = solids.prism(solids.circle(0.0045, 16, (0.213, 0)), 0.2)
    if variant == "copper":
        parts.append(steel_part(solids.cut(handle, hanger), rng))
    else:
        parts.append(dark_part(solids.cut(handle, hanger), rng))
    bracket = solids.rounded_box((0.016, 0.026, 0.014), 0.003, (0.0875, 0, 0.0245))
    parts.append(steel_part(bracket, rng))
    for y in (-0.009, 0.009):
        parts.append(steel_part(solids.ellipsoid((0.003, 0.0032, 0.0032), (0.0805, y, 0.0305), 10), rng))
    rings = np.asarray(handle.vertices)[: 8 * 20].reshape(8, 20, 3)
    hulls += pieces.chain(list(rings[[0, 2, 4, 6, 7]][:, ::2]))
    hulls.append(bracket.convex_hull)
    return BuiltObject(parts, hulls, mass=0.34, friction=0.7)


def _nonstick(rng: np.random.Generator, colour: Colour = (58, 58, 60), size: int = 384) -> np.ndarray:
    """A coated pan seen from above: fine rings of the turning tool, lighter towards the middle of the floor."""
    away = from_centre(size)
    rings = 0.95 + 0.1 * (0.5 + 0.5 * np.sin(away * 260))
    picture = shaded(np.full((size, size, 3), colour, dtype=np.uint8), rings * (1.12 - 0.2 * away))
    flecks = noise(rng, (size, size), (size // 3, size // 3)) > 0.97
    return over(picture, (150, 150, 150), flecks * 0.25)
