"""Drawing on pictures: colours, text, labels that avoid each other, arrows, contact sheets."""

from __future__ import annotations

import colorsys
from collections.abc import Sequence

import numpy as np
from PIL import Image, ImageDraw, ImageFont

Colour = tuple[int, int, int]
INK: Colour = (38, 40, 46)
PAPER: Colour = (250, 250, 248)
WARNING: Colour = (206, 38, 38)

_GOLDEN = 0.61803398875


def distinct_colours(count: int) -> list[Colour]:
    """``count`` colours that are easy to tell apart and dark enough for white text."""
    colours = []
    for k in range(count):
        red, green, blue = colorsys.hsv_to_rgb((0.58 + k * _GOLDEN) % 1.0, 0.78, (0.72, 0.55)[k % 2])
        colours.append((round(255 * red), round(255 * green), round(255 * blue)))
    return colours


VIEW, EDGE, CAPTION = 640, 16, 30
"""Of a contact sheet, pixels: default width of a view, space around it, and height of the caption above it."""

WORDS = 20
"""Text height of a contact sheet, pixels."""


def contact_sheet(views: Sequence[tuple[str, np.ndarray]], columns: int = 2, view: int = VIEW) -> np.ndarray:
    """Arrange captions and pictures, (H, W, 3) uint8, side by side at one width.

    Args:
        views: caption and picture of each.
        columns: how many to a row.
        view: width of each, pixels.

    Returns:
        (H', columns (view + EDGE) + EDGE, 3) uint8.
    """
    scaled = [(caption, _at_width(picture, view)) for caption, picture in views]
    rows = [scaled[k : k + columns] for k in range(0, len(scaled), columns)]
    heights = [CAPTION + max(len(picture) for _, picture in row) + EDGE for row in rows]
    paper = np.full((EDGE + sum(heights), EDGE + columns * (view + EDGE), 3), PAPER, dtype=np.uint8)
    canvas = Canvas(paper, text_size=WORDS)
    for row, top in zip(rows, EDGE + np.cumsum([0, *heights]), strict=False):
        for left, (caption, picture) in zip(range(EDGE, paper.shape[1], view + EDGE), row, strict=False):
            canvas.text((left, top), caption)
            canvas.paste((left, top + CAPTION), picture)
    return canvas.picture()


def _at_width(picture: np.ndarray, view: int) -> np.ndarray:
    height, width = picture.shape[:2]
    kind = Image.Resampling.BOX if width > view else Image.Resampling.BICUBIC
    return np.asarray(Image.fromarray(picture).resize((view, max(1, round(height * view / width))), kind))


class Canvas:
    """A picture to draw on; it remembers the places of labels.

    Args:
        picture: (H, W, 3) uint8.
        text_size: height of the labels' font, pixels.
    """

    def __init__(self, picture: np.ndarray, text_size: int):
        self.image = Image.fromarray(picture)
        self.draw = ImageDraw.Draw(self.image, "RGBA")
        self.font = ImageFont.load_default(text_size)
        self._text_size = text_size
        self._labels: list[tuple[float, float, float, float]] = []
        self._things: list[tuple[float, float, float, float]] = []

    def picture(self) -> np.ndarray:
        """(H, W, 3) uint8 copy of the drawing."""
        return np.array(self.image.convert("RGB"))

    def text(self, at: tuple[float, float], words: str, fill: Colour = INK, size: int | None = None) -> None:
        """Write words with their upper left corner at ``at``.

        Args:
            at: (u, v) of the corner, pixels.
            words: the text.
            fill: colour.
            size: height, pixels; that of the labels when not given.
        """
        self.draw.text(at, words, fill=fill, font=ImageFont.load_default(size) if size else self.font)

    def paste(self, at: tuple[int, int], picture: np.ndarray) -> None:
        """Paste a (H, W, 3) uint8 picture with its upper left corner at ``at``, (u, v) in pixels."""
        self.image.paste(Image.fromarray(picture), at)

    def arrow(self, start: Sequence[float], end: Sequence[float], colour: Colour, width: int = 3) -> None:
        """Draw an arrow with a light rim from ``start`` to ``end``; none where they nearly meet.

        Args:
            start, end: (u, v), pixels.
            colour: of the arrow.
            width: of its line, pixels.
        """
        tail, tip = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
        length = np.hypot(*(tip - tail))
        if length < 4 * width:
            return
        along = (tip - tail) / length
        across = np.array([-along[1], along[0]])
        neck = tip - along * 4.5 * width
        for fill, grow in ((PAPER, 2), (colour, 0)):
            self.draw.line([*tail, *neck], fill=fill, width=width + 2 * grow)
            head = [tip + along * grow, *(neck - along * grow + s * across * (2.2 * width + grow) for s in (1, -1))]
            self.draw.polygon([tuple(p) for p in head], fill=fill)

    def keep_clear(self, box: Sequence[float]) -> None:
        """Make later labels avoid ``box`` (u0, v0, u1, v1) where possible."""
        u0, v0, u1, v1 = box
        self._things.append((u0, v0, u1, v1))

    def label(self, box: Sequence[float], words: str, colour: Colour) -> None:
        """Draw a filled label beside ``box`` (u0, v0, u1, v1), clear of other labels where possible.

        Args:
            box: that it names, pixels.
            words: the text.
            colour: of the label; the words are white.
        """
        left, top, right, bottom = self.draw.textbbox((0, 0), words, font=self.font)
        pad = max(2, self._text_size // 5)
        size = np.array([right - left + 2 * pad, bottom - top + 2 * pad])
        room = np.array(self.image.size) - size
        corners = [np.clip(corner, 0, np.maximum(room, 0)) for corner in _corners_beside(box, size)]
        corner = min(corners, key=lambda at: self._covered(at, size))  # the first of equals: the nearest
        self._labels.append((*corner, *(corner + size)))
        self.draw.rounded_rectangle([*corner, *(corner + size)], radius=pad, fill=(*colour, 232))
        self.draw.text((corner[0] + pad - left, corner[1] + pad - top), words, fill=(255, 255, 255), font=self.font)

    def _covered(self, corner: np.ndarray, size: np.ndarray) -> float:
        """Area of labels, and a quarter of that of boxes to keep clear, under a label with this upper left corner."""
        area = 0.0
        for boxes, weight in ((self._labels, 4.0), (self._things, 1.0)):
            for u0, v0, u1, v1 in boxes:
                overlap = np.minimum(corner + size, (u1, v1)) - np.maximum(corner, (u0, v0))
                area += weight * float(np.prod(np.maximum(overlap, 0)))
        return area


def _corners_beside(box: Sequence[float], size: np.ndarray) -> list[np.ndarray]:
    """Upper left corners for a label near a box, the best first."""
    u0, v0, u1, v1 = box
    middle = (u0 + u1 - size[0]) / 2
    beside = (v0 + v1 - size[1]) / 2
    corners = []
    for away in (3, 3 + size[1], 3 + 2 * size[1]):
        above, below = v0 - size[1] - away, v1 + away
        corners += [
            (middle, above),
            (middle, below),
            (u0, above),
            (u1 - size[0], above),
            (u0, below),
            (u1 - size[0], below),
        ]
        corners += [(u1 + away, beside), (u0 - size[0] - away, beside)]
    return [np.array(corner, dtype=np.float64) for corner in corners]
