"""Each object in the source picture: its pixels, and the turned rectangle that it covers on the table."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from vcage.base.geometry import Camera, rotation_2d
from vcage.schema.scene import ObjectRecord, Scene

MIN_PIXELS = 12
"""A mask with fewer pixels says nothing about the object's shape."""


@dataclass(frozen=True)
class Cutout:
    """One object as it stands.

    Args:
        record: the object.
        mask: (H, W) bool, its visible pixels; empty when something hides it.
        centre: (2,) world x, y of its box.
        size: (2,) sides of the rectangle, the longer first, metres.
        hull: (n, 2) corners of the convex hull of its outline, relative to the centre, metres.
        height: z of the middle of its box: the plane in which its outline is measured.
    """

    record: ObjectRecord
    mask: np.ndarray
    centre: np.ndarray
    size: np.ndarray
    hull: np.ndarray
    height: float

    @property
    def hidden(self) -> bool:
        """True if the picture shows nothing of it."""
        return not self.mask.any()

    @cached_property
    def box(self) -> np.ndarray:
        """(2, 3) its world box as it stands."""
        return np.array(self.record.aabb, dtype=np.float64)

    def half_size(self, turn: float) -> np.ndarray:
        """(2,) half size of the axis-aligned rectangle around the object when turned by ``turn`` from where it is."""
        half = (self.box[1, :2] - self.box[0, :2]) / 2
        if turn == 0:
            return half
        hull = self.hull * (half / np.maximum(np.abs(self.hull).max(axis=0), 1e-6))
        return np.abs(hull @ rotation_2d(turn).T).max(axis=0)


def cutouts(scene: Scene, segmentation: np.ndarray) -> list[Cutout]:
    """Cutouts of all objects of the scene, in its order; what is heaped is cut out with its container."""
    camera, own = scene.top_camera.camera(), [record for record in scene.objects if not record.heaped]
    return [_cutout(record, segmentation == scene.segmentation_ids.get(record.id, -1), camera) for record in own]


def _cutout(record: ObjectRecord, mask: np.ndarray, camera: Camera) -> Cutout:
    box = np.array(record.aabb)
    height = float(box[:, 2].mean())
    centre = box[:, :2].mean(axis=0)
    rows, columns = np.nonzero(mask)
    if len(rows) < MIN_PIXELS:
        size = box[1, :2] - box[0, :2]
        hull = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * size / 2
        return Cutout(record, mask, centre, np.sort(size)[::-1], hull, height)
    pixels = np.stack([columns + 0.5, rows + 0.5], axis=1)
    points = camera.unproject(pixels, height)[:, :2]
    _, sides, _ = cv2.minAreaRect(points.astype(np.float32) * 1000)
    hull = cv2.convexHull(points.astype(np.float32))[:, 0].astype(np.float64) - centre
    return Cutout(record, mask, centre, np.sort(sides)[::-1] / 1000, hull, height)
