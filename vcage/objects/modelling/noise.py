"""Seamless noise and small picture operations that the painted textures are made of."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import ArrayLike

Colour = Sequence[int]
"""RGB, 0…255."""


def noise(rng: np.random.Generator, shape: tuple[int, int], cells: tuple[int, int]) -> np.ndarray:
    """(H, W) float32 in [0, 1]: smooth random values that repeat seamlessly, with ``cells`` (down, across) hills.

    Args:
        rng: draws the hills.
        shape: (H, W), pixels.
        cells: hills down and across.
    """
    grid = rng.random(cells).astype(np.float32)
    grid = np.pad(grid, 2, mode="wrap")
    rows = (np.arange(shape[0], dtype=np.float32) + 0.5) * cells[0] / shape[0] + 1.5
    columns = (np.arange(shape[1], dtype=np.float32) + 0.5) * cells[1] / shape[1] + 1.5
    u, v = np.meshgrid(columns, rows)
    return np.clip(cv2.remap(grid, u, v, cv2.INTER_CUBIC), 0, 1)


def clouds(
    rng: np.random.Generator, shape: tuple[int, int], cells: tuple[int, int] = (4, 4), octaves: int = 4
) -> np.ndarray:
    """(H, W) float32, roughly in [0, 1]: noise of several scales, each half as strong and twice as fine.

    Args:
        rng: draws the hills.
        shape: (H, W), pixels.
        cells: hills down and across of the coarsest noise.
        octaves: how many scales.
    """
    total, weight, out = 0.0, 1.0, np.zeros(shape, dtype=np.float32)
    for i in range(octaves):
        fine = (min(cells[0] << i, shape[0]), min(cells[1] << i, shape[1]))
        out += weight * noise(rng, shape, fine)
        total += weight
        weight /= 2
    return out / total


def blend(low: ArrayLike, high: ArrayLike, share: np.ndarray) -> np.ndarray:
    """(H, W, 3) uint8: from ``low`` (RGB) where ``share`` is 0 to ``high`` where it is 1.

    Args:
        low, high: RGB.
        share: (H, W), clipped to [0, 1].
    """
    share = np.clip(share, 0, 1)[..., None]
    return np.round((1 - share) * np.asarray(low) + share * np.asarray(high)).astype(np.uint8)


def over(picture: np.ndarray, colour: ArrayLike, cover: np.ndarray) -> np.ndarray:
    """``picture`` with ``colour`` (RGB) laid over it; ``cover`` (H, W) in [0, 1] is how much.

    Args:
        picture: (H, W, 3) uint8.
        colour: RGB, or (H, W, 3).
        cover: (H, W), clipped to [0, 1].
    """
    cover = np.clip(cover, 0, 1)[..., None]
    return np.round((1 - cover) * picture + cover * np.asarray(colour)).astype(np.uint8)


def shaded(picture: np.ndarray, factor: np.ndarray) -> np.ndarray:
    """``picture`` times ``factor`` (H, W), clipped."""
    return np.clip(np.round(picture * factor[..., None]), 0, 255).astype(np.uint8)
