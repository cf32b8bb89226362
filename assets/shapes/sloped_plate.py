"""Plates on a sloping face: screens, keys and labels."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import solids


def sloped_plate(
    size: tuple[float, float, float],
    low: tuple[float, float],
    high: tuple[float, float],
    x: float,
    share: float = 0.5,
    radius: float = 0.0004,
) -> solids.Solid:
    """A plate whose lower half is sunk into a slope that rises to the back.

    Args:
        size: width, length up the slope, thickness.
        low, high: ends (y, z) of the slope.
        x, share: where the plate's middle lies, ``share`` of the way up.
    """
    (y0, z0), (y1, z1) = low, high
    plate = solids.rounded_box(size, radius, (0, 0, -size[2] / 2), steps=1)
    middle = (x, y0 + share * (y1 - y0), z0 + share * (z1 - z0))
    return solids.moved(plate, middle, turn=float(np.degrees(np.arctan2(z1 - z0, y1 - y0))), axis=(1, 0, 0))
