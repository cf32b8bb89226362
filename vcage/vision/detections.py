"""Sound detections of a picture, and the detections that no matched object explains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.vision.protocols import Detection

PixelBox = tuple[float, float, float, float]
"""u0, v0, u1, v1, half open."""


@dataclass(frozen=True)
class DetectionLimits:
    """Limits for the use of detections.

    Args:
        most: detections of a picture that are used, the surest first.
        unclaimed_share: a detected box is unclaimed when more of it is table without a matched object.
        unclaimed_px: least area of the part of a detected mask that is left beside matched objects.
        beside_px: margin around a matched object that is left out.
        speck_px: parts of a detected mask that are narrower do not count.
    """

    most: int = 200
    unclaimed_share: float = 0.5
    unclaimed_px: int = 80
    beside_px: int = 4
    speck_px: int = 5


LIMITS = DetectionLimits()


def usable_detections(detections: Sequence[Detection], shape: tuple[int, ...]) -> tuple[list[Detection], list[str]]:
    """The surest detections whose box, score and mask fit a picture (H, W); and a note per kind that was left out."""
    notes = []
    sound = [
        d for d in detections if np.all(np.isfinite([*d.box, d.score])) and (d.mask is None or d.mask.shape == shape)
    ]
    if len(sound) < len(detections):
        count = len(detections) - len(sound)
        notes.append(f"{count} detections had no finite box and score, or a mask of another size")
    if len(sound) > LIMITS.most:
        notes.append(f"{len(sound)} things were detected in the target picture; the surest {LIMITS.most} are used")
        sound = sorted(sound, key=lambda d: -d.score)[: LIMITS.most]
    return sound, notes


def unclaimed_boxes(detections: Sequence[Detection], masks: Sequence[np.ndarray], region: np.ndarray) -> list[PixelBox]:
    """Boxes of detections on the table that matched objects do not cover.

    Each remaining part of a detected mask counts by itself: a stranger may touch a matched object.

    Args:
        detections: of the picture.
        masks: (H, W) bool, outlines of the matched objects.
        region: (H, W) bool, the table.
    """
    side = 2 * LIMITS.beside_px + 1
    free = region.astype(np.uint8)
    for mask in masks:
        free[cv2.dilate(mask.astype(np.uint8), np.ones((side, side), np.uint8)) > 0] = 0
    return [box for detection in detections for box in _free_parts(detection, free)]


def _free_parts(detection: Detection, free: np.ndarray) -> list[PixelBox]:
    """Boxes of the parts of a detection that lie where ``free`` (H, W) uint8 is 1."""
    if detection.mask is None:
        u0, v0, u1, v1 = (max(round(x), 0) for x in detection.box)
        inside = free[v0:v1, u0:u1]
        return [detection.box] if inside.size and inside.mean() > LIMITS.unclaimed_share else []
    kernel = np.ones((LIMITS.speck_px, LIMITS.speck_px), np.uint8)
    rest = cv2.morphologyEx(detection.mask.astype(np.uint8) & free, cv2.MORPH_OPEN, kernel)
    _, _, stats, _ = cv2.connectedComponentsWithStats(rest, connectivity=8)
    boxes = np.column_stack([stats[:, :2], stats[:, :2] + stats[:, 2:4]]).astype(float)
    large = [i for i in range(1, len(stats)) if stats[i, cv2.CC_STAT_AREA] >= LIMITS.unclaimed_px]
    return [(u0, v0, u1, v1) for u0, v0, u1, v1 in boxes[large].tolist()]
