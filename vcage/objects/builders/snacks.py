"""Filled and knotted breads."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from vcage.objects.builders import pieces, solids
from vcage.objects.builders.mappings import tiled
from vcage.objects.builders.parts import BuiltObject, Part, paint, variant_rng
from vcage.objects.textures import foods, skins
from vcage.objects.textures.noise import Colour


def sandwich(variant: str) -> BuiltObject:
    """Half a sandwich, cut lengthwise: 0.11 m along x, 0.056 m deep, its cut face with the filling to the front."""
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
        parts.append(paint(sheet, skins.cheese(rng, colour), tiled(0.06), roughness=roughness))
    return BuiltObject(parts, [pieces.hull(solids.prism(_loaf((0.11, 0.056)), 0.04).vertices)], mass=0.12, friction=0.8)


def pretzel(variant: str) -> BuiltObject:
    """A soft pretzel of 0.14 m, lying, its thick belly to the front."""
    rng = variant_rng("pretzel", variant)
    path = _pretzel_path()
    share = np.linspace(-1, 1, len(path))
    thickness = np.interp(np.abs(share), [0, 0.15, 0.4, 0.7, 0.95, 1], [1.1, 1.05, 0.82, 0.68, 0.58, 0.3])
    section = solids.circle(1.0, 14) * (0.0108, 0.0104)
    rope = solids.sweep(path, section, thickness)
    crust = foods.pretzel_crust(rng, salted=variant == "salted")
    part = paint(rope, crust, tiled(0.12), roughness=0.35, crease=60)
    rings = np.asarray(rope.vertices)[: len(path) * 14].reshape(len(path), 14, 3)
    return BuiltObject([part], pieces.chain(list(rings[::2])), mass=0.09, friction=0.8)


def _half_slice(
    bottom: float, height: float, crumb: Colour, crust: Colour, rng: np.random.Generator, seeds: bool
) -> list[Part]:
    """A slice of bread cut in half: crust to the left, to the right and at the back."""
    outer, rim = _loaf((0.11, 0.056)), 0.003
    inner = _loaf((0.11 - 2 * rim, 0.056 - rim)) - (0, rim / 2 + 0.0002)
    side = foods.plain_crust(rng, crust)
    inside = foods.tinted_crumb(rng, crumb, seeds)
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


def _pretzel_path() -> np.ndarray:
    """(n, 3) middle line of the rope: from the left end over the crossing, the right bow and the belly, and back."""
    right = np.array(
        [(-0.041, -0.0375, 0.0175), (-0.026, -0.011, 0.0115), (0.0, 0.02, 0.0085), (0.018, 0.036, 0.0085),
         (0.041, 0.042, 0.0085), (0.0585, 0.026, 0.0085), (0.0605, -0.002, 0.0088), (0.046, -0.034, 0.0098),
         (0.024, -0.0505, 0.011)]
    )  # fmt: skip
    left = right[::-1] * (-1, 1, 1)
    left[-3:, 2] = (0.0185, 0.0205, 0.0195)  # this end crosses above the other one
    left[-4, 2] = 0.012
    knots = np.concatenate([right, [(0.0, -0.0555, 0.0114)], left])
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(knots, axis=0), axis=1))])
    return CubicSpline(length, knots)(np.linspace(0, length[-1], 73))


BUILDERS = {"pretzel": pretzel, "sandwich": sandwich}
