"""Half a sandwich, cut lengthwise: 0.11 m along x, 0.056 m deep, its cut face with the filling to the front."""

from __future__ import annotations

import numpy as np

from assets.textures import foods
from vcage.objects.modelling import pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.noise import Colour, clouds, noise, over, shaded
from vcage.objects.modelling.parts import BuiltObject, Part, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("sandwich", variant)
    whole = variant == "wholegrain"
    crumb_colour, crust_colour = ((206, 164, 108), (116, 70, 34)) if whole else ((248, 234, 202), (196, 130, 66))
    parts: list[Part] = []
    for bottom in (0.0, 0.0275):
        parts += _half_slice(bottom, 0.0125, crumb_colour, crust_colour, rng, seeds=whole and bottom > 0)
    fillings = (
        ((0.112, 0.0575, 0.0035), 0.0125, (106, 160, 60), 0.0011, 0.8),  # lettuce
        ((0.106, 0.0555, 0.0045), 0.0155, (214, 62, 44), 0.0, 0.3),  # tomato
        ((0.107, 0.056, 0.0032), 0.0197, (248, 196, 70), 0.0, 0.5),  # cheese
        ((0.109, 0.0565, 0.005), 0.0226, (232, 150, 144), 0.0006, 0.5),  # ham
    )
    for size, bottom, colour, waves, roughness in fillings:
        sheet = solids.prism(_frilled(size[:2], waves), size[2], bottom)
        parts.append(paint(sheet, foods.cheese(rng, colour), tiled(0.06), roughness=roughness))
    return BuiltObject(parts, [pieces.hull(solids.prism(_loaf((0.11, 0.056)), 0.04).vertices)], mass=0.12, friction=0.8)


def _half_slice(
    bottom: float, height: float, crumb: Colour, crust: Colour, rng: np.random.Generator, seeds: bool
) -> list[Part]:
    """A slice of bread cut in half: crust to the left, to the right and at the back."""
    outer, rim = _loaf((0.11, 0.056)), 0.003
    inner = _loaf((0.11 - 2 * rim, 0.056 - rim)) - (0, rim / 2 + 0.0002)
    side = foods.plain_crust(rng, crust)
    inside = _tinted_crumb(rng, crumb, seeds)
    return [
        paint(solids.prism(outer, height - 0.0006, bottom + 0.0003), side, tiled(0.06), roughness=0.85),
        paint(solids.prism(inner, height, bottom), inside, tiled(0.07), roughness=0.95),
    ]


def _loaf(size: tuple[float, float]) -> np.ndarray:
    """Outline (n, 2), counter-clockwise: round corners at the back, sharp ones at the front."""
    x, y, bend = size[0] / 2, size[1] / 2, 0.013
    right = solids.arc((x - bend, y - bend), bend, 0, 90, 6)
    return np.concatenate([[(-x, -y), (x, -y)], right, right[::-1] * (-1, 1)])


def _frilled(size: tuple[float, float], waves: float) -> np.ndarray:
    """Outline (n, 2) of a leaf or slice whose edge goes in and out by ``waves`` metres."""
    outline = solids.rounded_rectangle(size, 0.013, 5)
    points = np.concatenate(
        [np.linspace(a, b, 8, endpoint=False) for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True)]
    )
    way = points / np.linalg.norm(points, axis=1, keepdims=True)
    return points - way * (waves * (0.5 + 0.5 * np.sin(np.arange(len(points)) * 1.3)))[:, None]


def _tinted_crumb(rng: np.random.Generator, colour: Colour, grains: bool = False, size: int = 192) -> np.ndarray:
    """Soft crumb of a colour with fine pores, and with grains when it is wholegrain bread."""
    shape = (size, size)
    picture = shaded(np.full((*shape, 3), colour, dtype=np.uint8), 0.93 + 0.1 * clouds(rng, shape, (6, 6)))
    picture = over(picture, np.asarray(colour) * 0.8, np.clip((noise(rng, shape, (34, 34)) - 0.8) * 5, 0, 0.6))
    return foods.scattered(rng, picture, [(98, 62, 32), (236, 214, 160)], 70, 4, 1.0) if grains else picture
