"""Faces of packed products: fronts with a name and a picture of what is inside, sides with facts and a bar code.

Faces are drawn at the size of the atlas cell that they fill, so that bars stay sharp.
"""

from __future__ import annotations

import cv2
import numpy as np

from assets.textures.labels import coded
from vcage.objects.modelling import prints
from vcage.objects.modelling.noise import Colour, blend


def darker(colour: Colour, factor: float = 0.6) -> Colour:
    """The colour times a factor."""
    return tuple(min(255, int(factor * c)) for c in colour)


def fading(size: tuple[int, int], top: Colour, bottom: Colour) -> np.ndarray:
    """A picture of (width, height) pixels that fades from one colour to another."""
    share = np.linspace(0, 1, size[1])[:, None] * np.ones((1, size[0]))
    return blend(top, bottom, share)


def ellipse(
    picture: np.ndarray,
    centre: tuple[float, float],
    radii: tuple[float, float],
    colour: Colour,
    turn: float = 0.0,
    angles: tuple[float, float] = (0, 360),
) -> np.ndarray:
    """The picture with a filled ellipse or a piece of it; ``radii`` are shares of the picture's height."""
    rows, columns = picture.shape[:2]
    at = (round(centre[0] * columns), round(centre[1] * rows))
    axes = (max(1, round(radii[0] * rows)), max(1, round(radii[1] * rows)))
    colour = tuple(int(c) for c in colour)
    return cv2.ellipse(picture.copy(), at, axes, turn, *angles, colour, -1, cv2.LINE_AA)


def brand(
    picture: np.ndarray, words: str, centre: tuple[float, float], height: float, ink: Colour, edge: Colour
) -> np.ndarray:
    """The picture with bold words that have an outline, as brand names do."""
    for reach, colour in ((0.085 * height, edge), (0.03 * height, ink)):
        across = reach * picture.shape[0] / picture.shape[1]
        for turn in np.linspace(0, 2 * np.pi, 12, endpoint=False):
            shifted = (centre[0] + across * np.cos(turn), centre[1] + reach * np.sin(turn))
            picture = prints.text(picture, words, shifted, height, colour)
    return picture


def facts(
    size: tuple[int, int], ground: Colour, names: tuple[str, ...], module: int = 2, share: float = 0.62
) -> np.ndarray:
    """A side panel: a table of facts in grey lines above, the product's bar code (see ``barcode``) below."""
    ink = (120, 116, 108)
    picture = prints.canvas(*size, ground)
    picture = prints.rectangle(picture, (0.1, 0.06), (0.9, 0.46), (250, 250, 246))
    rng = np.random.default_rng(sum(map(ord, "".join(names))))
    for i in range(7):
        y = 0.1 + 0.05 * i
        end = 0.5 + 0.12 * rng.random()
        picture = prints.rectangle(picture, (0.15, y), (end, y + 0.014), ink)
        picture = prints.rectangle(picture, (0.76, y), (0.85, y + 0.014), ink)
    return coded(picture, names, (0.5, 0.74), module, share)
