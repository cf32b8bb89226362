"""The embedder without weights: colours, shape and size of a masked region, independent of its rotation."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from vcage.vision.colour import to_lab
from vcage.vision.protocols import Detection

WEIGHTS = {"chroma": 0.40, "lightness": 0.15, "moments": 0.10, "area": 0.20, "aspect": 0.15}
"""Share of each block of features in the squared length, and so in the cosine similarity of two regions."""

_CHROMA_EDGES = np.linspace(-60, 60, 13)
_LIGHT_CENTRES = np.linspace(5, 95, 10)
_AREA_CENTRES = np.linspace(-9, -1.5, 16)
_ASPECT_CENTRES = np.linspace(0, 2.4, 9)


class ClassicalEmbedder:
    """Implements :class:`vcage.vision.protocols.Embedder` with histograms and moments."""

    provider = "offline"

    def embed(self, picture: np.ndarray, regions: Sequence[Detection]) -> np.ndarray:
        """(len(regions), d) float64 rows of unit length; none of the features depends on the region's rotation."""
        if not regions:
            return np.zeros((0, 0))
        lab = to_lab(picture)
        rows = [_features(lab, region) for region in regions]
        return np.array(rows, dtype=np.float64)


def _features(lab: np.ndarray, region: Detection) -> np.ndarray:
    whole = region.pixels(lab.shape).astype(np.uint8)
    u, v, width, height = cv2.boundingRect(whole)
    around = np.s_[max(v - 1, 0) : v + height + 1, max(u - 1, 0) : u + width + 1]
    lab, mask = lab[around], whole[around].astype(bool)
    inner = cv2.erode(whole[around], np.ones((3, 3), np.uint8)).astype(bool)
    colours = lab[inner if inner.sum() >= 20 else mask]
    long, short = _sides(mask)
    blocks = {
        "chroma": np.sqrt(_chroma_histogram(colours)),
        "lightness": np.sqrt(_soft_bins(colours[:, 0], _LIGHT_CENTRES).mean(axis=0)),
        "moments": _moments(mask),
        "area": np.sqrt(_soft_bins(np.log(mask.sum() / whole.size), _AREA_CENTRES)[0]),
        "aspect": np.sqrt(_soft_bins(np.log(long / short), _ASPECT_CENTRES)[0]),
    }
    return np.concatenate([np.sqrt(WEIGHTS[name]) * _unit(block) for name, block in blocks.items()])


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector)


def _soft_bins(values: np.ndarray | float, centres: np.ndarray) -> np.ndarray:
    """(n, k) memberships of values in overlapping bins; rows sum to 1."""
    width = centres[1] - centres[0]
    closeness = np.exp(-0.5 * ((np.reshape(values, (-1, 1)) - centres) / width) ** 2) + 1e-12
    return closeness / closeness.sum(axis=1, keepdims=True)


def _chroma_histogram(colours: np.ndarray) -> np.ndarray:
    """Smoothed histogram of (a, b), sum 1."""
    a, b = np.clip(colours[:, 1], -59, 59), np.clip(colours[:, 2], -59, 59)
    # pyrefly: ignore[no-matching-overload]  numpy's stub knows no array of edges for both axes
    counts, _, _ = np.histogram2d(a, b, bins=_CHROMA_EDGES)
    smooth = cv2.GaussianBlur(counts.astype(np.float64), (3, 3), 0.8, borderType=cv2.BORDER_REFLECT)
    return (smooth / smooth.sum()).ravel()


def _sides(mask: np.ndarray) -> tuple[float, float]:
    """Longer and shorter side of the smallest rectangle around a mask, pixels."""
    points = np.argwhere(mask).astype(np.float32)
    _, sides, _ = cv2.minAreaRect(points)
    return max(sides) + 1.0, min(sides) + 1.0


def _moments(mask: np.ndarray) -> np.ndarray:
    """Logarithms of the first Hu moments, in overlapping bins so that their likeness is a cosine."""
    hu = cv2.HuMoments(cv2.moments(mask.astype(np.uint8), binaryImage=True)).ravel()[:4]
    logs = np.log10(np.abs(hu) + 1e-6)
    return np.concatenate([np.sqrt(_soft_bins(value, np.linspace(-6, 0, 7))[0]) for value in logs])
