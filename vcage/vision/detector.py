"""The detector without weights: background subtraction without shadows, split into objects.

Where most of the picture differs from the empty table, the table was repainted. Then the pixels that stand out of
the table in the picture itself are used.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.vision.colour import to_lab
from vcage.vision.protocols import Detection
from vcage.vision.table_model import fit_table

MIN_AREA = 2e-4
"""Smallest share of the picture that is an object and not a speck."""


@dataclass(frozen=True)
class DetectorSettings:
    """Limits of background subtraction and of splitting.

    Args:
        colour_limit: least difference in L, or in a and b, of an object's pixel, Lab units.
        noise_factor: the limits grow to this many robust standard deviations of the noise between the pictures.
        shadow_least_light: least share of the light that a shadow leaves.
        shadow_tint: largest spread of the ratios of red, green and blue in a shadow; noise adds to it.
        shadow_roughness: largest spread of the ratio among neighbours in a shadow; noise adds to it.
        least_core_share: least depth of the core of a part that is split off, as a share of the deepest.
        new_table_share: the table was repainted when a larger share of the picture differs.
        spanning_share: floor or wall reaches across more of a picture with a repainted table.
    """

    colour_limit: float = 2.5
    noise_factor: float = 6.0
    shadow_least_light: float = 0.62
    shadow_tint: float = 0.03
    shadow_roughness: float = 0.12
    least_core_share: float = 0.35
    new_table_share: float = 0.5
    spanning_share: float = 0.9


SETTINGS = DetectorSettings()


class BackgroundDetector:
    """Implements :class:`vcage.vision.protocols.Detector`: background difference, components, watershed."""

    provider = "offline"

    def detect(
        self, picture: np.ndarray, names: Sequence[str], background: np.ndarray | None = None
    ) -> list[Detection]:
        """Regions that may be objects, the surest first.

        The number of ``names`` is expected: while fewer regions were found, components that look like several touching
        objects are split.
        """
        mask = foreground(picture, background)
        anew = background is not None and mask.mean() > SETTINGS.new_table_share
        if anew:
            mask = clean(fit_table(picture).salience > 0.5)
        pieces = [piece for piece in components(mask, MIN_AREA * mask.size) if not (anew and _spans(piece))]
        while len(pieces) < len(names):
            split = _split_best(pieces, picture, MIN_AREA * mask.size)
            if split is None:
                break
            pieces = split
        detections = [Detection.of_mask(piece, min(1.0, _solidity(piece))) for piece in pieces]
        return sorted(detections, key=lambda d: (-d.score, d.box))


def foreground(picture: np.ndarray, background: np.ndarray | None) -> np.ndarray:
    """(H, W) bool, pixels that differ from the empty table by more than light and shadow.

    Without a background, pixels that differ from the colours along the picture's border.
    """
    if background is None:
        return _unlike_border(picture)
    if background.shape != picture.shape:
        background = cv2.resize(background, (picture.shape[1], picture.shape[0]), interpolation=cv2.INTER_AREA)
    blurred, plain = (cv2.GaussianBlur(p, (3, 3), 0) for p in (picture, background))
    delta = to_lab(blurred) - to_lab(plain)
    delta -= np.median(delta.reshape(-1, 3), axis=0)
    noise = SETTINGS.noise_factor * 1.4826 * np.median(np.abs(delta.reshape(-1, 3)), axis=0)
    chroma = np.hypot(delta[..., 1], delta[..., 2])
    light = delta[..., 0]
    ratio = (blurred.astype(np.float32) + 4) / (plain.astype(np.float32) + 4)
    smooth = _local_spread(ratio.mean(axis=-1)) < SETTINGS.shadow_roughness + noise[0] / 100
    grey = np.ptp(ratio, axis=-1) < SETTINGS.shadow_tint + noise[0] / 100
    shadow = smooth & grey & (ratio.min(-1) > SETTINGS.shadow_least_light) & (light < 0)
    limit = SETTINGS.colour_limit
    differs = (chroma > max(limit, noise[1:].max())) | (np.abs(light) > max(limit, noise[0]))
    return clean(differs & ~shadow)


def _local_spread(values: np.ndarray) -> np.ndarray:
    """(H, W) standard deviation within 7 x 7 pixels."""
    mean, square = cv2.blur(values, (7, 7)), cv2.blur(np.square(values), (7, 7))
    return np.sqrt(np.maximum(square - mean * mean, 0))


def _unlike_border(picture: np.ndarray) -> np.ndarray:
    lab = to_lab(cv2.GaussianBlur(picture, (5, 5), 0))
    edge = max(2, min(lab.shape[:2]) // 40)
    border = np.concatenate([lab[:edge].reshape(-1, 3), lab[:, :edge].reshape(-1, 3), lab[:, -edge:].reshape(-1, 3)])
    middle = np.median(border, axis=0)
    spread = np.maximum(1.4826 * np.median(np.abs(border - middle), axis=0), 2.0)
    return clean((np.abs(lab - middle) / spread).max(axis=-1) > 5)


def clean(mask: np.ndarray) -> np.ndarray:
    """The mask with specks dropped, cracks closed and holes filled."""
    small, large = np.ones((3, 3), np.uint8), cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (7, 7))
    mask = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, small)
    mask = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, large)
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return cv2.drawContours(np.zeros_like(mask), contours, -1, (1,), cv2.FILLED).astype(bool)


def components(mask: np.ndarray, min_area: float) -> list[np.ndarray]:
    """The connected parts of a mask that have at least ``min_area`` pixels, each as a mask."""
    count, labels, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    return [labels == i for i in range(1, count) if stats[i, cv2.CC_STAT_AREA] >= min_area]


def _spans(piece: np.ndarray) -> bool:
    """True if a mask reaches across the picture."""
    return bool(max(piece.any(axis=0).mean(), piece.any(axis=1).mean()) > SETTINGS.spanning_share)


def _split_best(pieces: list[np.ndarray], picture: np.ndarray, min_area: float) -> list[np.ndarray] | None:
    """The pieces with the least convex one that can be split replaced by its parts; None if none can be split."""
    for index in np.argsort([_solidity(piece) for piece in pieces], kind="stable"):
        parts = _watershed(pieces[index], picture, min_area)
        if len(parts) > 1:
            return [piece for i, piece in enumerate(pieces) if i != index] + parts
    return None


def _solidity(piece: np.ndarray) -> float:
    """Area over the area of the convex hull."""
    contours, _ = cv2.findContours(piece.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    hull = cv2.convexHull(np.concatenate(contours))
    return float(piece.sum() / max(cv2.contourArea(hull), 1.0))


def _watershed(piece: np.ndarray, picture: np.ndarray, min_area: float) -> list[np.ndarray]:
    """Parts grown from the two deepest cores of a piece that a neck separates."""
    depth = cv2.distanceTransform(np.pad(piece.astype(np.uint8), 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
    for level in np.linspace(SETTINGS.least_core_share, 0.95, 13) * depth.max():
        count, markers = cv2.connectedComponents((depth > level).astype(np.uint8))
        if count > 2:
            break
    else:
        return [piece]
    markers[~piece] = count
    edges = cv2.watershed(cv2.cvtColor((depth / depth.max() * 255).astype(np.uint8), cv2.COLOR_GRAY2RGB), markers)
    parts = [(edges == i) & piece for i in range(1, count)]
    parts = [part for part in parts if part.sum() >= min_area]
    return parts if len(parts) > 1 else [piece]
