"""What a detector says of a picture: what of it can be used, and what no known object claims."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from vcage.vision.protocols import Detection

MOST_DETECTIONS = 200
"""Detections that are looked at, the surest first."""

UNCLAIMED_SHARE = 0.5
"""A detected box of which more is table and no matched object is unclaimed."""

LEAST_UNCLAIMED = 80
"""Pixels of a part of a detection that matched objects leave over, for it to be something."""

PixelBox = tuple[float, float, float, float]
"""u0, v0, u1, v1, half open."""


def region_of(mask: np.ndarray) -> Detection:
    """A mask (H, W), not empty, as a region for the embedder."""
    u, v, width, height = cv2.boundingRect(mask.astype(np.uint8))
    return Detection((float(u), float(v), float(u + width), float(v + height)), mask, 1.0)


def sound_detections(detections: Sequence[Detection], shape: tuple[int, ...]) -> tuple[list[Detection], list[str]]:
    """The surest detections, without those whose box, score or mask is none of a picture (H, W); and a note on each
    kind that was left out."""
    notes = []
    sound = [
        d for d in detections if np.all(np.isfinite([*d.box, d.score])) and (d.mask is None or d.mask.shape == shape)
    ]
    if len(sound) < len(detections):
        count = len(detections) - len(sound)
        notes.append(f"{count} detections had no finite box and score, or a mask of another size")
    if len(sound) > MOST_DETECTIONS:
        notes.append(f"{len(sound)} things were detected; the {MOST_DETECTIONS} surest were looked at")
        sound = sorted(sound, key=lambda d: -d.score)[:MOST_DETECTIONS]
    return sound, notes


def unclaimed_boxes(detections: Sequence[Detection], masks: Sequence[np.ndarray], region: np.ndarray) -> list[PixelBox]:
    """Boxes of what was detected on the table and is not covered by what was matched.

    Of a detection with a mask each part that is left counts by itself: a stranger may touch what was matched.

    Args:
        detections: of the picture.
        masks: (H, W) bool, what was matched.
        region: (H, W) bool, where the table is.
    """
    free = region.astype(np.uint8)
    for mask in masks:
        free[cv2.dilate(mask.astype(np.uint8), np.ones((9, 9), np.uint8)) > 0] = 0
    boxes: list[PixelBox] = []
    for d in detections:
        if d.mask is None:
            u0, v0, u1, v1 = (max(round(x), 0) for x in d.box)
            inside = free[v0:v1, u0:u1]
            if inside.size and inside.mean() > UNCLAIMED_SHARE:
                boxes.append((float(d.box[0]), float(d.box[1]), float(d.box[2]), float(d.box[3])))
            continue
        rest = cv2.morphologyEx(d.mask.astype(np.uint8) & free, cv2.MORPH_OPEN, np.ones((5, 5), np.uint8))
        _, _, stats, _ = cv2.connectedComponentsWithStats(rest, connectivity=8)
        for u, v, width, height, area in stats[1:].tolist():
            if area >= LEAST_UNCLAIMED:
                boxes.append((float(u), float(v), float(u + width), float(v + height)))
    return boxes
