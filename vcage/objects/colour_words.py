"""Everyday words for measured colours."""

from __future__ import annotations

import colorsys
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from vcage.objects.modelling.parts import Part

HUES = ((15, "red"), (42, "orange"), (70, "yellow"), (165, "green"), (195, "cyan"), (260, "blue"), (300, "purple"))
"""Upper end of each hue in degrees; larger hues are pink, then red again."""

COLOUR_WORDS = frozenset({*(word for _, word in HUES), "pink", "brown", "black", "white", "grey", "gray", "violet"})
"""Words that name a colour in a phrase."""


def colour_word(parts: Sequence[Part]) -> str:
    """The word for the mean colour of all surfaces, weighted by their area."""
    total, weight = np.zeros(3), 0.0
    for part in parts:
        corners = part.vertices[part.faces]
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        total += areas @ _colours_at(part.texture, part.uv[part.faces].mean(axis=1))
        weight += float(areas.sum())
    return word_of(total / max(weight, 1e-12))


def _colours_at(texture: np.ndarray, uv: np.ndarray) -> np.ndarray:
    height, width = texture.shape[:2]
    column = (uv[:, 0] % 1.0 * width).astype(int).clip(0, width - 1)
    row = ((1 - uv[:, 1] % 1.0) * height).astype(int).clip(0, height - 1)
    return texture[row, column].astype(np.float64)


def word_of(colour: np.ndarray) -> str:
    """The everyday word for an sRGB colour (3,) from 0 to 255."""
    hue, lightness, _ = colorsys.rgb_to_hls(*(np.asarray(colour) / 255))
    chroma = (np.max(colour) - np.min(colour)) / 255
    if chroma < 0.12:
        return "black" if lightness < 0.2 else "white" if lightness > 0.8 else "grey"
    degrees = hue * 360
    name = next((word for end, word in HUES if degrees < end), "pink" if degrees < 345 else "red")
    return "brown" if name in ("red", "orange") and degrees > 10 and lightness < 0.45 else name
