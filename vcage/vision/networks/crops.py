"""Regions of a picture as squares of one size for a network: the object alone, on neutral ground, turned."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import cv2
import numpy as np

from vcage.vision.protocols import Detection

MEAN = np.array([0.485, 0.456, 0.406], np.float32)
SPREAD = np.array([0.229, 0.224, 0.225], np.float32)
"""Mean and standard deviation of ImageNet's colours, RGB in [0, 1]. Networks that were trained on it take colours
less the mean over the deviation, so 0 is a ground on which they see nothing."""

MARGIN = 1.1
"""Side of a crop, in diameters of the smallest circle around the region."""

TURNS = 4
"""Quarter turns that features are summed over, so that they hardly depend on how an object is turned."""

BATCH = 32
"""Crops that go through a network at once."""

Network = Callable[[np.ndarray], np.ndarray]
"""(n, 3, side, side) float32 crops to (n, d) features."""


def turned_features(picture: np.ndarray, regions: Sequence[Detection], side: int, network: Network) -> np.ndarray:
    """(len(regions), d) float64 unit rows: the network's features, summed over quarter turns of each crop."""
    if not regions:
        return np.zeros((0, 0))
    crops = [crop(picture, region, side) for region in regions]
    turned = np.stack([np.rot90(square, turn) for square in crops for turn in range(TURNS)])
    batches = np.split(turned.transpose(0, 3, 1, 2), range(BATCH, len(turned), BATCH))
    features = np.concatenate([network(np.ascontiguousarray(batch)) for batch in batches])
    summed = features.astype(np.float64).reshape(len(crops), TURNS, -1).sum(axis=1)
    return summed / np.maximum(np.linalg.norm(summed, axis=1, keepdims=True), 1e-12)


def crop(picture: np.ndarray, region: Detection, side: int) -> np.ndarray:
    """(side, side, 3) float32 of a region, normalised; 0 off the region, and all 0 where it holds no pixel.

    The square is centred on the smallest circle around the region, so its scale does not depend on the heading.
    """
    mask = mask_of(region, picture.shape[:2])
    v, u = np.nonzero(mask)
    if not len(u):
        return np.zeros((side, side, 3), np.float32)
    window = np.s_[v.min() : v.max() + 1, u.min() : u.max() + 1]
    (x, y), radius = cv2.minEnclosingCircle(np.stack([u - u.min(), v - v.min()], axis=1).astype(np.float32))
    scale = side / (MARGIN * 2 * (radius + 0.5))
    alone = (picture[window].astype(np.float32) / 255 - MEAN) / SPREAD * mask[window][..., None]
    if scale < 1:
        # A pixel of the crop takes in several of the picture, which interpolation alone would skip.
        alone = cv2.GaussianBlur(alone, (0, 0), 0.5 / scale, borderType=cv2.BORDER_CONSTANT)
    middle = (side - 1) / 2
    warp = np.array([[scale, 0, middle - scale * x], [0, scale, middle - scale * y]])
    return cv2.warpAffine(alone, warp, (side, side), flags=cv2.INTER_LINEAR)


def mask_of(region: Detection, shape: tuple[int, ...]) -> np.ndarray:
    """(H, W) bool: the region's mask, else its box as far as it lies in the picture; empty when neither does."""
    if region.mask is not None and region.mask.shape == tuple(shape) and region.mask.any():
        return region.mask
    mask = np.zeros(shape, bool)
    if np.isfinite(region.box).all():
        u0, v0, u1, v1 = np.clip(region.box, 0, [shape[1], shape[0]] * 2)
        mask[int(v0) : int(np.ceil(v1)), int(u0) : int(np.ceil(u1))] = True
    return mask
