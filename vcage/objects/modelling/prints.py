"""Printed things: labels, covers, keypads, and six-sided atlases for boxes."""

from __future__ import annotations

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from vcage.objects.modelling.noise import Colour


def canvas(width: int, height: int, colour: Colour) -> np.ndarray:
    """A plain picture (height, width, 3).

    Args:
        width, height: pixels.
        colour: RGB.
    """
    return np.full((height, width, 3), colour, dtype=np.uint8)


def text(
    picture: np.ndarray,
    words: str,
    centre: tuple[float, float],
    height: float,
    colour: Colour = (255, 255, 255),
    *,
    turn: float = 0.0,
) -> np.ndarray:
    """The picture with a line of text.

    Args:
        centre: where its middle goes, as shares of width and height from the upper left.
        height: of the letters as a share of the picture's height.
        turn: degrees counter-clockwise.
    """
    rows, columns = picture.shape[:2]
    font = ImageFont.load_default(size=max(6, height * rows))
    left, top, right, bottom = font.getbbox(words)
    stamp = Image.new("L", (int(right - left) + 4, int(bottom - top) + 4), 0)
    ImageDraw.Draw(stamp).text((2 - left, 2 - top), words, font=font, fill=255)
    stamp = stamp.rotate(turn, expand=True, resample=Image.Resampling.BICUBIC)
    out = Image.fromarray(picture)
    corner = (round(centre[0] * columns - stamp.width / 2), round(centre[1] * rows - stamp.height / 2))
    out.paste(tuple(int(c) for c in colour), corner, stamp)
    return np.asarray(out).copy()


def rectangle(
    picture: np.ndarray, lower: tuple[float, float], upper: tuple[float, float], colour: Colour
) -> np.ndarray:
    """The picture with a filled rectangle; corners as shares from the upper left.

    Args:
        picture: (H, W, 3) uint8.
        lower, upper: corners, as shares of width and height from the upper left.
        colour: RGB.
    """
    rows, columns = picture.shape[:2]
    out = picture.copy()
    out[round(lower[1] * rows) : round(upper[1] * rows), round(lower[0] * columns) : round(upper[0] * columns)] = colour
    return out


def disc(picture: np.ndarray, centre: tuple[float, float], radius: float, colour: Colour) -> np.ndarray:
    """The picture with a filled circle; ``radius`` is a share of the picture's height.

    Args:
        picture: (H, W, 3) uint8.
        centre: as shares of width and height from the upper left.
        radius: as a share of the height.
        colour: RGB.
    """
    rows, columns = picture.shape[:2]
    out = np.ascontiguousarray(picture)
    at = (round(centre[0] * columns), round(centre[1] * rows))
    return cv2.circle(out.copy(), at, max(1, round(radius * rows)), tuple(int(c) for c in colour), -1, cv2.LINE_AA)


def atlas(sides: dict[str, np.ndarray], rest: Colour, cell: tuple[int, int] = (192, 192)) -> np.ndarray:
    """Six pictures side by side as :func:`vcage.objects.modelling.mappings.six_sides` reads them.

    Args:
        sides: picture by side; sides that are missing take the colour ``rest``.
        cell: (width, height) of a cell.
    """
    order = (("front", "right", "back"), ("left", "top", "bottom"))
    blank = canvas(*cell, rest)
    scaled = {side: cv2.resize(picture, cell, interpolation=cv2.INTER_AREA) for side, picture in sides.items()}
    return np.concatenate([np.concatenate([scaled.get(side, blank) for side in row], axis=1) for row in order])
