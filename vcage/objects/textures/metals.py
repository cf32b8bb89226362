"""Polished metal."""

from __future__ import annotations

import numpy as np

from vcage.objects.textures.noise import Colour, shaded

REFLECTIONS = ((0.06, 0.035, -0.30), (0.17, 0.06, 0.22), (0.33, 0.03, -0.26), (0.46, 0.05, 0.3), (0.62, 0.04, -0.34))
"""Dark and bright streaks of a room as a round body shows it: position and width as shares of a turn, strength."""


def polished(colour: Colour, size: int = 256) -> np.ndarray:
    """Polished metal to be wrapped once around a body of revolution: upright streaks, seamless."""
    share = (np.arange(size) + 0.5) / size
    tone = np.full(size, 0.95)
    for position, width, strength in (*REFLECTIONS, (0.82, 0.07, 0.2)):
        distance = np.abs((share - position + 0.5) % 1 - 0.5)
        tone += strength * np.exp(-((distance / width) ** 2))
    picture = np.full((size // 4, size, 3), colour, dtype=np.uint8)
    return shaded(picture, np.broadcast_to(tone, picture.shape[:2]))
