"""Marks around a dial: clocks and timers."""

from __future__ import annotations

import cv2
import numpy as np

from vcage.objects.modelling.noise import Colour


def on_circle(angle: float, radius: float) -> tuple[float, float]:
    """A point, as shares from the upper left, at an angle clockwise from the top."""
    return 0.5 + radius * float(np.sin(angle)), 0.5 - radius * float(np.cos(angle))


def ray(picture: np.ndarray, angle: float, reach: tuple[float, float], width: float, colour: Colour) -> np.ndarray:
    """A line from one distance of the middle to another, at an angle clockwise from the top.

    Args:
        picture: square, (n, n, 3).
        angle: radians, clockwise from the top.
        reach: distances from the middle, as shares.
        width: as a share.
        colour: RGB.
    """
    size = len(picture)
    start, end = (tuple(round(c * size) for c in on_circle(angle, radius)) for radius in reach)
    ink = tuple(int(c) for c in colour)
    return cv2.line(np.ascontiguousarray(picture).copy(), start, end, ink, max(1, round(width * size)), cv2.LINE_AA)
