"""Colours in CIELAB, and how far pictures and palettes are from each other in it."""

from __future__ import annotations

import cv2
import numpy as np

LIGHTNESS_WEIGHT = 0.5
"""Lightness counts less than hue and chroma: shade changes it, and nothing else."""


def to_lab(picture: np.ndarray) -> np.ndarray:
    """(H, W, 3) float32 CIELAB (L in [0, 100]) of an RGB uint8 picture."""
    return cv2.cvtColor(picture.astype(np.float32) / 255, cv2.COLOR_RGB2LAB)


def distance(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(...) colour distance of Lab arrays (..., 3), lightness counting less."""
    delta = a - b
    delta = delta * np.array([LIGHTNESS_WEIGHT, 1, 1], dtype=np.float32)
    return np.sqrt((delta * delta).sum(axis=-1))


def palette(colours: np.ndarray, count: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """The main colours of (n, 3) Lab pixels: centres (k, 3) and shares (k,), the most frequent first.

    k-means from evenly spaced pixels of the lightness order, so the same pixels give the same palette.
    """
    samples = np.ascontiguousarray(colours.reshape(-1, 3), dtype=np.float32)
    count = min(count, len(samples))
    order = np.argsort(samples[:, 0], kind="stable")
    seeds = order[np.linspace(0, len(order) - 1, 2 * count + 1).astype(int)[1::2]]
    labels = np.argmin(((samples[:, None] - samples[seeds][None]) ** 2).sum(-1), axis=1).astype(np.int32)
    criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 20, 0.5)
    _, labels, centres = cv2.kmeans(samples, count, labels[:, None].copy(), criteria, 1, cv2.KMEANS_USE_INITIAL_LABELS)
    shares = np.bincount(labels.ravel(), minlength=count) / len(samples)
    ranked = np.argsort(-shares, kind="stable")
    return centres[ranked], shares[ranked]


def palette_distance(lab: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """(H, W) distance of each pixel to the nearest palette colour."""
    return np.min([distance(lab, centre) for centre in centres.astype(np.float32)], axis=0)
