"""Boxes in a picture: cut to it, and those of the same thing made one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vcage.vision.protocols import Detection

Box = tuple[float, float, float, float]
"""u0, v0, u1, v1 in pixels, half open."""


def clipped(box: Sequence[float] | np.ndarray, shape: tuple[int, ...], largest: float = 1.0) -> Box | None:
    """The part of a box inside a picture of that shape.

    None where it is no number, has less than a pixel's area left, or covers more than the share ``largest``.
    """
    box = np.asarray(box, dtype=np.float64)
    if not np.isfinite(box).all():
        return None
    u0, v0, u1, v1 = (float(x) for x in np.clip(box, 0, [shape[1], shape[0]] * 2))
    area = max(u1 - u0, 0) * max(v1 - v0, 0)
    return (u0, v0, u1, v1) if 1 <= area <= largest * shape[0] * shape[1] else None


def distinct(detections: Sequence[Detection], overlap: float) -> list[Detection]:
    """The detections without those whose box overlaps an earlier one's by more: greedy non-maximum suppression.

    Args:
        detections: the best first.
        overlap: intersection over union above which two boxes are the same thing.
    """
    boxes = np.array([d.box for d in detections], dtype=np.float64).reshape(-1, 4)
    chosen: list[int] = []
    for index in range(len(detections)):
        if not chosen or overlaps(boxes[index], boxes[chosen]).max() <= overlap:
            chosen.append(index)
    return [detections[index] for index in chosen]


def overlaps(box: np.ndarray, others: np.ndarray) -> np.ndarray:
    """(n,) intersection over union of a box (4,) with others (n, 4)."""
    lower, upper = np.maximum(box[:2], others[:, :2]), np.minimum(box[2:], others[:, 2:])
    shared = np.prod(np.maximum(upper - lower, 0), axis=1)
    areas = np.prod(np.maximum(others[:, 2:] - others[:, :2], 0), axis=1)
    area = float(np.prod(np.maximum(box[2:] - box[:2], 0)))
    return shared / np.maximum(area + areas - shared, 1e-12)
