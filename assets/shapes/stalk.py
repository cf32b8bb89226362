"""Stalks of fruit and vegetables."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import Part, paint

LEAF = (74, 124, 54)


def stalk(
    path: list[tuple[float, float, float]],
    radius: float,
    colour: tuple[int, int, int],
    rng: np.random.Generator,
    side: tuple[float, float, float] = (0, 1, 0),
) -> Part:
    """A stalk along a path, thicker at its cut end; ``side`` is any direction that the path never takes.

    Args:
        path: (n, 3) points, metres.
        radius: metres.
        colour: RGB.
        rng: for the surface.
        side: any direction that the path never takes.
    """
    scales = np.linspace(0.85, 1.15, len(path))
    solid = solids.sweep(np.array(path), solids.circle(radius, 10), scales, up=side)
    return paint(solid, materials.plastic(rng, colour), tiled(0.05), roughness=0.85)
