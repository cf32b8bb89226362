"""Brings the colours of the target picture back to those of the source.

The table cannot tell how an image model changed the colours, as it may be painted anew; the objects can, as they are
the same. First by their colours as a whole, then pixel by pixel once some are found.
"""

from __future__ import annotations

import cv2
import numpy as np

from vcage.vision.object_templates import Crop, View
from vcage.vision.pose_score import pixels_of, placed, turned_towards

GAINS = (0.7, 1.5)
"""Smallest and largest factor of a colour channel."""

SURE = 0.6
"""Salience of a pixel that belongs to an object."""

LEAST = 60
"""Fewer pixels say nothing about colours."""

STIFFNESS = 0.05
"""Weight of "the colours are right already" in the fit, as a share of the pixels'."""


def recolour(view: View, source: View, masks: np.ndarray) -> View:
    """The target with the mean and spread of what stands out made those of the objects of the source.

    Args:
        masks: (H, W) bool, where objects are in the source.
    """
    known = source.lab[masks]
    standing = cv2.erode((view.salience > SURE).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    found = view.lab[standing]
    if min(len(known), len(found)) < LEAST:
        return view
    gain = np.clip(known.std(axis=0) / np.maximum(found.std(axis=0), 1e-3), *GAINS)
    return _changed(view, gain, known.mean(axis=0) - gain * found.mean(axis=0))


def refit(view: View, known: np.ndarray, found: np.ndarray) -> View:
    """The target with gain and offset of each channel fitted to pixels (n, 3) of objects that were found.

    Outliers (highlights, shadows, wrong matches) lose their weight.
    """
    if len(known) < LEAST:
        return view
    gain, offset = np.ones(3), np.zeros(3)
    for channel in range(3):
        x, y = found[:, channel].astype(np.float64), known[:, channel].astype(np.float64)
        middle = float(np.median(x))
        design = np.stack([x - middle, np.ones_like(x)], axis=1)
        prior = np.diag([STIFFNESS * 100.0, STIFFNESS]) * len(x)
        answer = np.array([1.0, middle])
        for _ in range(5):
            left = y - design @ answer
            weight = 1 / (1 + (left / max(1.4826 * np.median(np.abs(left)), 1.0)) ** 2)
            matrix = (design * weight[:, None]).T @ design + prior
            answer = np.linalg.solve(matrix, (design * weight[:, None]).T @ y + prior @ [1.0, middle])
        gain[channel] = np.clip(answer[0], *GAINS)
        offset[channel] = answer[1] - gain[channel] * middle
    return _changed(view, gain, offset)


def pairs_of(view: View, crop: Crop, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) Lab of the points of a crop that show at a pose (4,), and of the target where they are."""
    at = placed(crop, pose[None], crop.points)
    shown = turned_towards(crop, pose[None], at, crop.facing)[0] >= 0
    return crop.colours[shown], view.sample(pixels_of(crop.camera, at), crop.step)[0, shown, :3]


def _changed(view: View, gain: np.ndarray, offset: np.ndarray) -> View:
    return View(view.lab * gain.astype(np.float32) + offset.astype(np.float32), view.salience)
