"""A soft pretzel of 0.14 m, lying, its thick belly to the front."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from assets.textures.foods import scattered
from vcage.objects.modelling import pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.noise import blend, clouds
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("pretzel", variant)
    path = _pretzel_path()
    share = np.linspace(-1, 1, len(path))
    thickness = np.interp(np.abs(share), [0, 0.15, 0.4, 0.7, 0.95, 1], [1.1, 1.05, 0.82, 0.68, 0.58, 0.3])
    section = solids.circle(1.0, 14) * (0.0108, 0.0104)
    rope = solids.sweep(path, section, thickness)
    crust = _pretzel_crust(rng, salted=variant == "salted")
    part = paint(rope, crust, tiled(0.12), roughness=0.35, crease=60)
    rings = np.asarray(rope.vertices)[: len(path) * 14].reshape(len(path), 14, 3)
    return BuiltObject([part], pieces.chain(list(rings[::2])), mass=0.09, friction=0.8)


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


def _pretzel_crust(rng: np.random.Generator, salted: bool, size: int = 384) -> np.ndarray:
    """Lye crust for all sides: deep brown, with grains of coarse salt."""
    shape = (size, size)
    picture = blend((104, 46, 18), (168, 88, 36), clouds(rng, shape, (7, 7)) * 1.3 - 0.15)
    if not salted:
        return picture
    return scattered(rng, picture, [(252, 250, 246), (236, 232, 224)], count=260, length=3, reach=0.98)
