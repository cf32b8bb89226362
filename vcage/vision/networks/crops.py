"""Square crops of regions for a network: the object alone, on neutral ground, at four quarter turns."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import cv2
import numpy as np

from vcage.vision.protocols import Detection

MEAN = np.array([0.485, 0.456, 0.406], np.float32)
SPREAD = np.array([0.229, 0.224, 0.225], np.float32)
"""Mean and standard deviation of ImageNet's colours, RGB in [0, 1]. Networks that were trained on it take
(colour - mean) / deviation, so 0 is a neutral ground."""


Network = Callable[[np.ndarray], np.ndarray]
"""(n, 3, side, side) float32 crops to (n, d) features."""


def turned_features(
    picture: np.ndarray, regions: Sequence[Detection], side: int, network: Network, batch: int = 32
) -> np.ndarray:
    """(len(regions), d) float64 unit rows: the network's features, summed over the quarter turns of each crop.

    So they hardly depend on the object's heading. ``batch`` crops go through the network at once.
    """
    if not regions:
        return np.zeros((0, 0))
    crops = [crop(picture, region, side) for region in regions]
    turned = np.stack([np.rot90(square, turn) for square in crops for turn in range(4)])
    batches = np.split(turned.transpose(0, 3, 1, 2), range(batch, len(turned), batch))
    features = np.concatenate([network(np.ascontiguousarray(some)) for some in batches])
    summed = features.astype(np.float64).reshape(len(crops), 4, -1).sum(axis=1)
    return summed / np.maximum(np.linalg.norm(summed, axis=1, keepdims=True), 1e-12)


def crop(picture: np.ndarray, region: Detection, side: int, diameters: float = 1.1) -> np.ndarray:
    """(side, side, 3) float32 of a region, normalised; 0 outside the region, and all 0 if it holds no pixel.

    The square is centred on the smallest circle around the region and ``diameters`` of it wide, so its scale does not
    depend on the heading.
    """
    mask = region.pixels(picture.shape)
    v, u = np.nonzero(mask)
    if not len(u):
        return np.zeros((side, side, 3), np.float32)
    window = np.s_[v.min() : v.max() + 1, u.min() : u.max() + 1]
    (x, y), radius = cv2.minEnclosingCircle(np.stack([u - u.min(), v - v.min()], axis=1).astype(np.float32))
    scale = side / (diameters * 2 * (radius + 0.5))
    alone = (picture[window].astype(np.float32) / 255 - MEAN) / SPREAD * mask[window][..., None]
    if scale < 1:
        # A pixel of the crop covers several of the picture, some of which interpolation alone would skip.
        alone = cv2.GaussianBlur(alone, (0, 0), 0.5 / scale, borderType=cv2.BORDER_CONSTANT)
    middle = (side - 1) / 2
    warp = np.array([[scale, 0, middle - scale * x], [0, scale, middle - scale * y]])
    return cv2.warpAffine(alone, warp, (side, side), flags=cv2.INTER_LINEAR)
