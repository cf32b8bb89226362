"""Everyday words for colours."""

from __future__ import annotations

import colorsys

import numpy as np

HUES = ((15, "red"), (42, "orange"), (70, "yellow"), (165, "green"), (195, "cyan"), (260, "blue"), (300, "purple"))
"""Upper end of each hue in degrees; larger hues are pink, then red again."""

COLOUR_WORDS = frozenset({*(word for _, word in HUES), "pink", "brown", "black", "white", "grey", "gray", "violet"})
"""Words that name a colour in a phrase."""


def word_of(colour: np.ndarray) -> str:
    """The everyday word for an sRGB colour (3,) from 0 to 255."""
    hue, lightness, _ = colorsys.rgb_to_hls(*(np.asarray(colour) / 255))
    chroma = (np.max(colour) - np.min(colour)) / 255
    if chroma < 0.12:
        return "black" if lightness < 0.2 else "white" if lightness > 0.8 else "grey"
    degrees = hue * 360
    name = next((word for end, word in HUES if degrees < end), "pink" if degrees < 345 else "red")
    return "brown" if name in ("red", "orange") and degrees > 10 and lightness < 0.45 else name
