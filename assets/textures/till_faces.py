"""Paper and frames of the things around a till."""

from __future__ import annotations

import numpy as np

from assets.textures.labels import INK
from vcage.objects.modelling import prints
from vcage.objects.modelling.noise import Colour

PAPER: Colour = (250, 249, 244)


def framed(picture: np.ndarray, colour: Colour, share: float = 0.07) -> np.ndarray:
    """The picture within a border; ``share`` of its height wide."""
    edge = round(share * picture.shape[0])
    rows, columns = picture.shape[:2]
    out = prints.canvas(columns + 2 * edge, rows + 2 * edge, colour)
    out[edge:-edge, edge:-edge] = picture
    return out


def receipt(size: tuple[int, int], rows: int) -> np.ndarray:
    """A printed receipt of (width, height) pixels: a heading, ``rows`` lines with prices, and the total."""
    picture = prints.canvas(*size, PAPER)
    step = 1 / (rows + 4)
    letters = 0.85 * step
    picture = prints.text(picture, "CORNER SHOP", (0.5, 1.1 * step), letters, INK)
    rng = np.random.default_rng(rows)
    for i in range(rows):
        y = (2.4 + i) * step
        end = rng.uniform(0.35, 0.6)
        picture = prints.rectangle(picture, (0.08, y - 0.18 * step), (end, y + 0.18 * step), (120, 120, 122))
        picture = prints.rectangle(picture, (0.76, y - 0.18 * step), (0.92, y + 0.18 * step), (120, 120, 122))
    y = (2.9 + rows) * step
    picture = prints.text(picture, "TOTAL", (0.25, y), letters, INK)
    return prints.text(picture, "12.50", (0.78, y), letters, INK)
