"""Bands of spatial frequencies of two pictures, as ColorVideoVDP takes them apart: a Laplacian pyramid of contrast."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

Planes = NDArray[Any]
"""(H, C, W) float32, their channels achromatic, red-green and yellow-violet, of one picture or of two. So OpenCV
filters all of them at once: columns of (H, C·W), and rows of (H·C, W)."""

KERNEL = np.array([0.05, 0.25, 0.4, 0.25, 0.05], np.float32)
"""Of the Gaussian pyramid."""


@dataclass(frozen=True)
class Band:
    """The contrast of two pictures in one band of spatial frequencies.

    Args:
        test, reference: (H, 3, W) contrasts.
        background: (H, W) the reference's light around each pixel, or its mean over the picture.
        cycles_per_degree: frequency of the band.
        base: true for the last one, all that is coarser than the others.
    """

    test: Planes
    reference: Planes
    background: Planes
    cycles_per_degree: float
    base: bool


def bands(pair: Planes, pixels_per_degree: float, darkest: float = 0.01, most_contrast: float = 1000) -> Iterator[Band]:
    """Yield the bands of two pictures, the finest first.

    Args:
        pair: (H, 6, W) light of the test, then of the reference.
        pixels_per_degree: of the display.
        darkest: least light around a pixel, cd/m².
        most_contrast: largest contrast.
    """
    frequencies = _frequencies(min(pair.shape[0], pair.shape[2]), pixels_per_degree)
    fine = pair
    for number, frequency in enumerate(frequencies):
        base = number == len(frequencies) - 1
        if base:
            layer, background = fine, np.maximum(fine[:, ::3], darkest).mean(axis=(0, 2), keepdims=True)
        else:
            coarse = _reduced(fine)
            around = _expanded(coarse, fine.shape[0], fine.shape[2])
            layer, background, fine = fine - around, np.maximum(around[:, ::3], np.float32(darkest)), coarse
        gain = np.float32(1 if base or number == 0 else 2)
        test, reference = (layer[:, 3 * n : 3 * n + 3] / background[:, n : n + 1] for n in range(2))
        for contrast in (test, reference):
            np.minimum(contrast, np.float32(most_contrast), out=contrast)
            contrast *= gain
        yield Band(test, reference, np.ascontiguousarray(background[:, 1]), 0.1 if base else frequency, base)


def _frequencies(side: int, pixels_per_degree: float, lowest: float = 0.2) -> list[float]:
    """Return the frequencies of the bands, cycles per degree, those of the last without meaning.

    Args:
        side: of the picture, the shorter, pixels.
        pixels_per_degree: of the display.
        lowest: of the bands.
    """
    nyquist = pixels_per_degree / 2
    found = [nyquist] + [nyquist * 0.3228 * 2.0**-number for number in range(14)]
    most = int(math.log2(side)) - 1
    first = next((number for number, frequency in enumerate(found) if frequency <= lowest), most)
    return found[: min(first + 1, most) + 1]


def _reduced(planes: Planes) -> Planes:
    """Return planes of half the size; beyond their edges they are mirrored."""
    height, _, width = planes.shape
    rows = np.ascontiguousarray(along(planes, KERNEL, cv2.BORDER_REFLECT)[::2])
    small = np.ascontiguousarray(across(rows, KERNEL, cv2.BORDER_REFLECT)[..., ::2])
    if height % 2 != width % 2:  # the package goes by the number of rows where it fills up the last column
        end, near = KERNEL[:2]
        missing = near * rows[..., -1] + end * (rows[..., -2] - rows[..., -1])
        small[..., -1] += missing if height % 2 else -missing
    return small


def _expanded(planes: Planes, height: int, width: int) -> Planes:
    """Return planes of twice the size; beyond their edges they go on as they end."""
    end, near, middle = 2 * KERNEL[:3]
    even, odd, edge = (end, middle, end), (0, near, near), cv2.BORDER_REPLICATE
    rows = np.empty((height, *planes.shape[1:]), np.float32)
    rows[::2], rows[1::2] = along(planes, even, edge), along(planes, odd, edge)[: height // 2]
    columns = [across(rows, kernel, edge).reshape(-1, planes.shape[2]) for kernel in (even, odd)]
    return cv2.merge(columns).reshape(height, planes.shape[1], -1)[..., :width]


ONE = np.ones(1, np.float32)


def along(planes: Planes, kernel: ArrayLike, border: int) -> Planes:
    """Return planes filtered along their columns."""
    columns = planes.reshape(len(planes), -1)
    return cv2.sepFilter2D(columns, -1, ONE, np.array(kernel, np.float32), borderType=border).reshape(planes.shape)


def across(planes: Planes, kernel: ArrayLike, border: int) -> Planes:
    """Return planes filtered along their rows."""
    rows = planes.reshape(-1, planes.shape[2])
    return cv2.sepFilter2D(rows, -1, np.array(kernel, np.float32), ONE, borderType=border).reshape(planes.shape)
