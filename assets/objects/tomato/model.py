"""A tomato of 0.066 m with its green calyx."""

from __future__ import annotations

import numpy as np

from assets.shapes import lumps
from assets.shapes.stalk import LEAF, stalk
from assets.textures import foods
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {"red": ((186, 24, 20), (214, 46, 28)), "yellow": ((232, 160, 36), (246, 190, 60))}
"""Variant → low, high."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("tomato", variant)
    low, high = VARIANTS[variant]
    knots = [
        (0.002, 0.0015),
        (0.009, 0),
        (0.021, 0.005),
        (0.031, 0.018),
        (0.0328, 0.027),
        (0.029, 0.04),
        (0.02, 0.0485),
    ]
    knots += [(0.012, 0.0505), (0.006, 0.049), (0.002, 0.047)]
    profile = lumps.smooth(knots, 28)
    groove = np.interp(profile[:, 1], [0, 0.02, 0.035, 0.05], [0.02, 0.012, 0.03, 0.07])
    body = lumps.lobed(profile, 5, groove, 50)
    leaves = [_sepal(2 * np.pi * (i + 0.2) / 6, 0.019, 0.0485) for i in range(6)]
    stem = stalk([(0, 0, 0.046), (0.0004, 0, 0.051), (0.0016, 0, 0.056), (0.004, 0, 0.06)], 0.0022, LEAF, rng)
    green = materials.plastic(rng, LEAF)
    parts = [paint(body, foods.glossy_skin(rng, low, high, (206, 118, 40)), around(), roughness=0.22), stem]
    parts += [paint(leaf, green, tiled(0.03), roughness=0.8) for leaf in leaves]
    calyx = pieces.coarse(np.concatenate([leaf.vertices for leaf in leaves]))
    hulls = [lumps.standing(body, 0.01), calyx, pieces.coarse(stem.vertices, 24)]
    return BuiltObject(parts, hulls, mass=0.12, friction=0.7)


def _sepal(turn: float, reach: float, z: float) -> solids.Solid:
    """A pointed leaf from the z axis outwards that first hugs the fruit and then lifts its tip."""
    share = np.array([0.1, 0.35, 0.65, 1.0])
    rise = np.array([0.001, 0.0028, 0.0022, 0.0026])
    path = np.column_stack([np.cos(turn) * share * reach, np.sin(turn) * share * reach, z + rise])
    section = np.array([(-0.0032, 0), (0, -0.0008), (0.0032, 0), (0, 0.0008)])
    return solids.sweep(path, section, [0.7, 1.0, 0.75, 0.08])
