"""A muffin in a pleated paper case, 0.066 m across and 0.06 m high."""

from __future__ import annotations

import numpy as np

from assets.shapes import lumps
from vcage.objects.modelling import pieces, solids
from vcage.objects.modelling.mappings import around
from vcage.objects.modelling.noise import Colour, blend, clouds, over, shaded
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "blueberry": ((226, 172, 98), (48, 42, 96), (236, 226, 200)),
    "chocolate": ((98, 60, 36), (44, 24, 16), (176, 128, 84)),
    "vanilla": ((236, 194, 122), (214, 66, 76), (150, 196, 206)),
}
"""Variant → dough, bits, paper."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("muffin", variant)
    dough, bits, paper = VARIANTS[variant]
    case = lumps.lobed(
        [(0.001, 0), (0.0225, 0), (0.0235, 0.001), (0.0292, 0.0345), (0.0285, 0.035), (0.001, 0.034)],
        24,
        [0, 0.03, 0.05, 0.06, 0.06, 0],
        96,
    )
    knots = [
        (0.001, 0.031),
        (0.026, 0.0315),
        (0.0325, 0.036),
        (0.033, 0.041),
        (0.0275, 0.051),
        (0.018, 0.0575),
        (0.001, 0.0605),
    ]
    top = solids.displaced(lumps.lobed(lumps.smooth(knots, 22), count=40), 0.0011, 0.022, rng)
    crust = _muffin_top(rng, dough, bits)
    parts = [
        paint(case, _pleated(rng, paper), around(), roughness=0.9, crease=15),
        paint(top, crust, lumps.over_dome((0, 0, 0.03), 95.0), roughness=0.75),
    ]
    hulls = [pieces.stack([(0.0228, 0), (0.0235, 0.001), (0.0288, 0.0345)]), pieces.coarse(top.vertices, 90)]
    return BuiltObject(parts, hulls, mass=0.09, friction=0.8)


def _muffin_top(rng: np.random.Generator, colour: Colour, bits: Colour, count: int = 22, size: int = 256) -> np.ndarray:
    """A muffin seen from above: cracked crust, browner at its edge, with berries or pieces of chocolate."""
    shape = (size, size)
    axis = np.linspace(-1, 1, size)
    columns, rows = np.meshgrid(axis, axis)
    away = np.hypot(rows, columns)
    picture = blend(colour, np.asarray(colour) * 0.68, away * 0.9 + 0.7 * (clouds(rng, shape, (6, 6)) - 0.5))
    cracks = np.clip(1 - np.abs(clouds(rng, shape, (5, 5), 4) - 0.52) * 24, 0, 1) * (away < 0.8)
    picture = over(picture, np.asarray(colour) * 0.5, cracks * 0.4)
    for _ in range(count):
        turn, far = rng.uniform(0, 2 * np.pi), 0.62 * np.sqrt(rng.random())
        spot = np.hypot(rows - far * np.sin(turn), columns - far * np.cos(turn)) / rng.uniform(0.045, 0.085)
        picture = over(picture, bits, np.clip((1 - spot) * 5, 0, 0.95))
    return picture


def _pleated(rng: np.random.Generator, colour: Colour, pleats: int = 24) -> np.ndarray:
    """A paper case: light and dark pleats around."""
    shape = (96, 20 * pleats)
    wave = np.abs(np.sin(np.arange(shape[1]) * np.pi / 20))[None] ** 0.7
    tone = (0.7 + 0.32 * wave) * (0.95 + 0.08 * clouds(rng, shape, (3, 12)))
    return shaded(np.full((*shape, 3), colour, dtype=np.uint8), tone)
