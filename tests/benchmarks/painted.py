"""A case whose pictures are painted: coloured bars on a grey table, so that no renderer is needed."""

from __future__ import annotations

import cv2
import numpy as np

from benchmarks._match.cases import Case
from benchmarks._match.truth import TrueObject, Truth
from tests.example_scenes import scene_of, thing

COLOURS = {"block": ((200, 40, 40), (240, 200, 60)), "stapler": ((40, 60, 190), (60, 190, 90))}
"""Of the two halves of each object's bar."""

SIZES = {"block": (44, 44), "stapler": (90, 36)}
"""Of the bars, pixels."""

MOVED = {"block": ((0.15, 0.1), 0.4), "stapler": ((-0.2, -0.1), -0.9)}
"""Where the objects are in the target picture: x, y in metres, and yaw."""


def painted_case() -> Case:
    """A block and a stapler that are moved and turned."""
    objects = [thing("block", (-0.2, 0.05)), thing("stapler", (0.15, -0.05))]
    scene = scene_of(objects).model_copy(update={"segmentation_ids": {"block": 1, "stapler": 2}})
    noise = np.random.default_rng(0).normal(0, 1.5, (480, 640, 3))
    background = np.clip(150 + noise, 0, 255).astype(np.uint8)
    source, target, segmentation = background.copy(), background.copy(), np.zeros((480, 640), np.int32)
    camera = scene.top_camera.camera()
    for record in scene.objects:
        middle = (record.aabb[0][2] + record.aabb[1][2]) / 2
        place, yaw = MOVED[record.id]
        pixel = camera.project([*record.pose.position[:2], middle])
        paint(source, pixel, 0.0, record.id, segmentation, scene.segmentation_ids[record.id])
        paint(target, camera.project([*place, middle]), yaw, record.id)
    truth = [TrueObject(id=name, present=True, position=place, yaw=yaw) for name, (place, yaw) in MOVED.items()]
    return Case("painted/000", scene, source, segmentation, background, target, Truth(level="painted", objects=truth))


def paint(
    picture: np.ndarray, pixel: np.ndarray, yaw: float, name: str, labels: np.ndarray | None = None, value: int = 0
) -> None:
    """A bar of two colours about a pixel, turned counter-clockwise."""
    width, height = SIZES[name]
    c, s = np.cos(yaw), np.sin(yaw)
    for colour, (left, right) in zip(COLOURS[name], ((-0.5, 0.1), (0.1, 0.5)), strict=True):
        corners = np.array([(left, -0.5), (right, -0.5), (right, 0.5), (left, 0.5)]) * [width, height]
        turned = corners @ np.array([[c, -s], [s, c]])  # v points down
        polygon = np.rint(turned + pixel - 0.5).astype(np.int32)
        cv2.fillConvexPoly(picture, polygon, colour)
        if labels is not None:
            cv2.fillConvexPoly(labels, polygon, value)
