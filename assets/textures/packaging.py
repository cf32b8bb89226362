"""Printed packs and soft papers of a household: fitted lettering, wrap-around labels, motifs, cloth and paper."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from PIL import ImageFont

from vcage.objects.modelling import prints
from vcage.objects.modelling.noise import Colour, blend, clouds, noise, over, shaded

GRAPHITE = (44, 46, 52)

WHITE = (248, 248, 245)

TextLine = tuple[str, float, float, float, Colour]
"""Words, their middle from the top, and the room they fill, across and down, as shares of the picture; colour."""


def fitted(
    picture: np.ndarray,
    words: str,
    centre: tuple[float, float],
    room: tuple[float, float],
    colour: Colour,
    *,
    upright: bool = False,
) -> np.ndarray:
    """The picture with a line of text as large as fits a rectangle.

    Args:
        centre: where its middle goes, as shares from the upper left.
        room: length and height of the line as shares of the picture's width and height, or of its height and
            width when it is upright.
        upright: the line reads from the bottom up.
    """
    rows, columns = picture.shape[:2]
    left, top, right, bottom = ImageFont.load_default(size=100).getbbox(words)
    long, tall = (rows, columns) if upright else (columns, rows)
    size = min(room[0] * long / (right - left), room[1] * tall / (bottom - top)) * 100
    return prints.text(picture, words, centre, size / rows, colour, turn=90 if upright else 0)


def label(
    size: tuple[int, int],
    ground: Colour,
    lines: Sequence[TextLine],
    bands: Sequence[tuple[float, float, Colour]] = (),
    places: Sequence[float] = (0.0, 0.5, 1.0),
) -> np.ndarray:
    """A label with stripes across it and the same lines at some places along it.

    Args:
        size: (width, height), pixels.
        bands: (from, to, colour), shares of the height from the top.
        places: middles of the lines, shares of the width; 0 and 1 are the back of a wrapped label.
    """
    picture = prints.canvas(*size, ground)
    for low, high, colour in bands:
        picture = prints.rectangle(picture, (0, low), (1, high), colour)
    for words, y, width, height, colour in lines:
        for x in places:
            picture = fitted(picture, words, (x, y), (width, height), colour)
    return picture


def polygon(picture: np.ndarray, points: Sequence[tuple[float, float]], colour: Colour) -> np.ndarray:
    """The picture with a filled polygon; corners as shares from the upper left."""
    rows, columns = picture.shape[:2]
    corners = np.round(np.array(points) * (columns, rows)).astype(np.int32)
    return cv2.fillPoly(np.ascontiguousarray(picture).copy(), [corners], tuple(int(c) for c in colour), cv2.LINE_AA)


def stroke(
    picture: np.ndarray, points: Sequence[tuple[float, float]], width: float, colour: Colour, *, closed: bool = False
) -> np.ndarray:
    """The picture with a line through points; ``width`` is a share of the picture's height."""
    rows, columns = picture.shape[:2]
    corners = np.round(np.array(points) * (columns, rows)).astype(np.int32)
    thick = max(1, round(width * rows))
    out = np.ascontiguousarray(picture).copy()
    return cv2.polylines(out, [corners], closed, tuple(int(c) for c in colour), thick, cv2.LINE_AA)


def cross(picture: np.ndarray, centre: tuple[float, float], reach: float, colour: Colour) -> np.ndarray:
    """The picture with an upright cross whose arms reach a share of the picture's height from its centre."""
    rows, columns = picture.shape[:2]
    x, y = centre
    long, short = np.array([reach * rows / columns, reach]), np.array([reach * rows / columns, reach]) / 3
    for half in ((long[0], short[1]), (short[0], long[1])):
        picture = prints.rectangle(picture, (x - half[0], y - half[1]), (x + half[0], y + half[1]), colour)
    return picture


def terry(rng: np.random.Generator, colour: Colour, size: int = 256) -> np.ndarray:
    """Towelling: loops in rows."""
    shape = (size, size)
    loops = noise(rng, shape, (size // 5, size // 5))
    rows = 0.5 + 0.5 * np.sin(np.arange(size) * 2 * np.pi * 24 / size)[:, None]
    tone = 0.84 + 0.14 * loops + 0.05 * rows + 0.04 * clouds(rng, shape)
    return shaded(np.full((*shape, 3), colour, dtype=np.uint8), tone)


def quilted(rng: np.random.Generator, colour: Colour = (246, 245, 241), size: int = 512) -> np.ndarray:
    """Soft paper with a pressed pattern of crossing dotted lines; repeats seamlessly."""
    shape = (size, size)
    rows, columns = np.meshgrid(np.arange(size) / size, np.arange(size) / size, indexing="ij")
    tone = 0.97 + 0.05 * clouds(rng, shape, (6, 6))
    for turn in (rows + columns, rows - columns):
        lines = np.abs(np.sin(np.pi * turn * 10)) < 0.09
        tone = np.where(lines & (np.sin(np.pi * rows * 160) > -0.4), tone * 0.86, tone)
    return shaded(np.full((*shape, 3), colour, dtype=np.uint8), tone)


def windings(colour: Colour, turns: int, dark: float = 0.85, size: int = 384) -> np.ndarray:
    """The end of something rolled up: a spiral from the middle of the picture."""
    axis = np.linspace(-1, 1, size)
    columns, rows = np.meshgrid(axis, axis)
    away, angle = np.hypot(columns, rows), np.arctan2(rows, columns) / (2 * np.pi)
    phase = (away * turns + angle) % 1.0
    edge = np.clip(1 - np.abs(phase - 0.5) * 5, 0, 1)
    return shaded(np.full((size, size, 3), colour, dtype=np.uint8), 1 - (1 - dark) * edge)


def cotton(
    rng: np.random.Generator, colour: Colour = (250, 250, 248), size: tuple[int, int] = (512, 256)
) -> np.ndarray:
    """Cotton balls behind glass, ``size`` (width, height): round white tufts with soft shadows between them."""
    width, height = size
    picture = prints.canvas(width, height, (204, 210, 216))
    step = height // 5
    for row in range(-1, 7):
        for column in range(-1, width // step + 2):
            at = np.array([column * step + (row % 2) * step / 2, row * step * 0.86]) + rng.uniform(-4, 4, 2)
            for share, tone in ((0.62, 0.9), (0.52, 0.96), (0.36, 1.0)):
                tint = tuple(int(c * tone) for c in colour)
                middle = (round(at[0] - step * (0.62 - share) * 0.3), round(at[1] - step * (0.62 - share) * 0.4))
                cv2.circle(picture, middle, round(step * share), tint, -1, cv2.LINE_AA)
    return shaded(picture, 0.95 + 0.07 * noise(rng, (height, width), (height // 5, width // 5)))


def calendar_page(month: str, first: int, days: int, accent: Colour, size: tuple[int, int] = (448, 352)) -> np.ndarray:
    """A month: its name on a band, the week days, the days in rows of seven, Sundays coloured.

    Args:
        first: column of day 1, Monday 0.
        size: (width, height), pixels.
    """
    page = prints.canvas(*size, (250, 249, 245))
    page = prints.rectangle(page, (0, 0), (1, 0.24), accent)
    page = fitted(page, month, (0.5, 0.125), (0.8, 0.12), (252, 252, 250))
    for column, letter in enumerate("MTWTFSS"):
        page = fitted(page, letter, (0.11 + 0.13 * column, 0.32), (0.05, 0.05), (110, 112, 118))
    for day in range(1, days + 1):
        row, column = divmod(first + day - 1, 7)
        ink = accent if column == 6 else (44, 46, 52)
        page = fitted(page, str(day), (0.11 + 0.13 * column, 0.43 + 0.105 * row), (0.075, 0.058), ink)
    return page


def knurled(rng: np.random.Generator, colour: Colour, size: int = 256, cells: int = 32) -> np.ndarray:
    """Metal with a crossed grip pattern."""
    rows, columns = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    turn = 2 * np.pi * cells / size / 2
    tone = 0.8 + 0.22 * np.sin((rows + columns) * turn) * np.sin((rows - columns) * turn)
    return shaded(
        np.full((size, size, 3), colour, dtype=np.uint8), tone * (0.95 + 0.1 * clouds(rng, (size, size), (4, 4)))
    )


def striped(colours: Sequence[Colour], stripes: int, size: tuple[int, int] = (256, 32)) -> np.ndarray:
    """Upright stripes in turns, ``size`` (width, height): ribs of caps, transparent barrels."""
    which = np.arange(size[0]) * stripes // size[0] % len(colours)
    return np.repeat(np.asarray(colours, dtype=np.uint8)[which][None], size[1], axis=0)


def frosted(rng: np.random.Generator, low: Colour, high: Colour, size: tuple[int, int] = (256, 256)) -> np.ndarray:
    """Tinted glass or clear plastic, ``size`` (width, height): a smooth fall of tone from top to bottom."""
    width, height = size
    fall = np.linspace(1, 0, height)[:, None] * np.ones((1, width))
    return over(blend(low, high, fall), high, 0.25 * clouds(rng, (height, width), (3, 3)))
