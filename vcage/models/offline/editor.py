"""The image editor that needs no model: cuts each object out and pastes it where the plan wants it."""

from __future__ import annotations

import cv2
import numpy as np

from vcage.errors import InputFileError
from vcage.geometry import Camera
from vcage.models.offline import PROVIDER
from vcage.models.offline.arrange import Placement, arrange
from vcage.models.offline.footprints import Footprint, footprints
from vcage.models.protocols import EditRequest

SHADOW_DEPTH = 0.22
"""How much light the middle of a pasted shadow takes away."""


class OfflineEditor:
    """Implements :class:`vcage.models.protocols.ImageEditor` with the plan solved on the table plane."""

    provider = PROVIDER

    def rearrange(self, request: EditRequest) -> np.ndarray:
        """The target picture, in the size of the source.

        Raises:
            InputFileError: the pictures do not belong together.
        """
        _check_sizes(request)
        camera = request.scene.top_camera.camera()
        items = footprints(request.scene, request.segmentation)
        placements = arrange(request.scene, request.plan, items)
        canvas = request.background.astype(np.float32)
        for item in sorted(items, key=lambda item: item.record.aabb[0][2]):
            if item.mask.any():
                warp = _warp(camera, item, placements[item.record.id])
                canvas = _paste(canvas, request.picture, item, warp)
        return np.clip(np.rint(canvas), 0, 255).astype(np.uint8)


def _check_sizes(request: EditRequest) -> None:
    camera = request.scene.top_camera
    for name, array in (
        ("picture", request.picture),
        ("background", request.background),
        ("segmentation", request.segmentation),
    ):
        if array.shape[:2] != (camera.height, camera.width):
            raise InputFileError(
                f"the {name} is {array.shape[1]} x {array.shape[0]} pixels, the top camera's pictures are "
                f"{camera.width} x {camera.height}",
                hint="run select_place again with --force",
            )


def _warp(camera: Camera, item: Footprint, placement: Placement) -> np.ndarray:
    """(3, 3) homography of source pixels to target pixels for points in the plane of the object's middle.

    In that plane the centre of a box's silhouette moves exactly as the box does; perspective is kept.
    """
    corners = item.centre + np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * max(item.size[0] / 2, 0.01)
    c, s = np.cos(placement.turn), np.sin(placement.turn)
    moved = (corners - item.centre) @ np.array([[c, s], [-s, c]]) + placement.centre
    lift = np.full((4, 1), item.height)
    source = camera.project(np.hstack([corners, lift]))
    target = camera.project(np.hstack([moved, lift]))
    return cv2.getPerspectiveTransform(source.astype(np.float32), target.astype(np.float32))


def _paste(canvas: np.ndarray, picture: np.ndarray, item: Footprint, warp: np.ndarray) -> np.ndarray:
    """The canvas (H, W, 3) float32 with the object's soft shadow and then the object on it."""
    size = (canvas.shape[1], canvas.shape[0])
    half_pixel = np.array([[1, 0, -0.5], [0, 1, -0.5], [0, 0, 1.0]])
    warp = half_pixel @ warp @ np.linalg.inv(half_pixel)
    colour = cv2.inpaint(picture, (~item.mask & _near(item.mask)).astype(np.uint8), 3, cv2.INPAINT_TELEA)
    moved = cv2.warpPerspective(colour, warp, size, flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    alpha = cv2.warpPerspective(item.mask.astype(np.float32), warp, size, flags=cv2.INTER_LINEAR)[..., None]
    blur = 2 * int(max(2, min(item.size) * size[0] / 60)) + 1
    shadow = cv2.GaussianBlur(alpha, (blur, blur), 0)[..., None]
    canvas = canvas * (1 - SHADOW_DEPTH * shadow)
    return canvas * (1 - alpha) + moved.astype(np.float32) * alpha


def _near(mask: np.ndarray) -> np.ndarray:
    """Pixels up to three pixels from the mask, so that interpolation at its edge sees the object's own colour."""
    return cv2.dilate(mask.astype(np.uint8), np.ones((7, 7), np.uint8)).astype(bool)
