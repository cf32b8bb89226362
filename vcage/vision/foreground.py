"""Which pixels differ from the empty table, leaving shadows out."""

from __future__ import annotations

import cv2
import numpy as np

from vcage.vision.colour import to_lab

CHROMA_LIMIT = 2.5
"""Least difference in a, b above which a pixel is an object's."""

LIGHT_LIMIT = 2.5
"""Least difference in L above which a pixel is an object's."""

NOISE_FACTOR = 6.0
"""The limits grow with the noise between the two pictures: so many robust standard deviations."""

SHADOW_FLOOR = 0.62
"""A shadow leaves at least this share of the light."""

SHADOW_TINT = 0.03
"""A shadow takes nearly the same share of red, green and blue: largest spread of the three ratios. Noise adds to it."""

SHADOW_ROUGHNESS = 0.12
"""A shadow darkens evenly: largest spread of the ratio among neighbours. Noise adds to it."""


def foreground(picture: np.ndarray, background: np.ndarray | None) -> np.ndarray:
    """(H, W) bool: pixels that differ from the empty table by more than light and shadow.

    Without a background, what differs from the colours along the picture's border.
    """
    if background is None:
        return _unlike_border(picture)
    if background.shape != picture.shape:
        background = cv2.resize(background, (picture.shape[1], picture.shape[0]), interpolation=cv2.INTER_AREA)
    blurred, plain = (cv2.GaussianBlur(p, (3, 3), 0) for p in (picture, background))
    delta = to_lab(blurred) - to_lab(plain)
    delta -= np.median(delta.reshape(-1, 3), axis=0)
    noise = NOISE_FACTOR * 1.4826 * np.median(np.abs(delta.reshape(-1, 3)), axis=0)
    chroma = np.hypot(delta[..., 1], delta[..., 2])
    light = delta[..., 0]
    ratio = (blurred.astype(np.float32) + 4) / (plain.astype(np.float32) + 4)
    smooth = _local_spread(ratio.mean(axis=-1)) < SHADOW_ROUGHNESS + noise[0] / 100
    shadow = (
        smooth & (ratio.min(-1) > SHADOW_FLOOR) & (np.ptp(ratio, axis=-1) < SHADOW_TINT + noise[0] / 100) & (light < 0)
    )
    differs = (chroma > max(CHROMA_LIMIT, noise[1:].max())) | (np.abs(light) > max(LIGHT_LIMIT, noise[0]))
    return clean(differs & ~shadow)


def _local_spread(values: np.ndarray) -> np.ndarray:
    """(H, W) standard deviation within 7 x 7 pixels."""
    mean, square = (cv2.blur(v, (7, 7)) for v in (values, values * values))
    return np.sqrt(np.maximum(square - mean * mean, 0))


def _unlike_border(picture: np.ndarray) -> np.ndarray:
    lab = to_lab(cv2.GaussianBlur(picture, (5, 5), 0))
    edge = max(2, min(lab.shape[:2]) // 40)
    border = np.concatenate([lab[:edge].reshape(-1, 3), lab[:, :edge].reshape(-1, 3), lab[:, -edge:].reshape(-1, 3)])
    middle = np.median(border, axis=0)
    spread = np.maximum(1.4826 * np.median(np.abs(border - middle), axis=0), 2.0)
    return clean((np.abs(lab - middle) / spread).max(axis=-1) > 5)


def clean(mask: np.ndarray) -> np.ndarray:
    """Specks dropped, cracks closed, holes filled."""
    small, large = np.ones((3, 3), np.uint8), cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (7, 7))
    mask = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, small)
    mask = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, large)
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return cv2.drawContours(np.zeros_like(mask), contours, -1, 1, cv2.FILLED).astype(bool)
