"""A picture of a camera on a hand beside drawings of what that hand presses or holds.

The robot's file tells where the fingers are in the picture. How the arm stood is not known: the hand may have come to
the thing in several ways, and each way has drawings of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.models.protocols import HandView
from vcage.models.rules.drawings import ANY_LIGHT, Draw, LightRange, as_bright, drawn_whole
from vcage.models.rules.evidence.parts import edges_and_hues, unlike
from vcage.sim.drawer import Drawing
from vcage.vision.colour import to_lab


@dataclass(frozen=True)
class HandPictureSettings:
    """Size of the pictures that are compared.

    Args:
        width_px: about the width to which a picture of the hand's camera is reduced.
        least_contrast: standard deviation of the light of a picture, of 255, below which it shows nothing.
    """

    width_px: int = 80
    least_contrast: float = 2.0


SETTINGS = HandPictureSettings()


class HandPicture:
    """A picture of a camera on a hand, reduced: fewer pixels tell as much.

    Args:
        picture: (H, W, 3) uint8 RGB.
        camera: that takes such pictures, wherever.
        light: in which the picture may be taken.

    Attributes:
        picture: (h, w, 3) uint8 RGB, reduced.
        lab: the same in CIELAB.
        shows: whether there is anything to see.
    """

    def __init__(self, picture: np.ndarray, camera: Camera, light: LightRange = ANY_LIGHT):
        self._light = light
        self._step = max(1, round(camera.width / SETTINGS.width_px))
        small = (camera.width // self._step, camera.height // self._step)
        self.picture = cv2.resize(picture, small, interpolation=cv2.INTER_AREA)
        self.lab = to_lab(self.picture)
        self.shows = bool(self.picture.std() >= SETTINGS.least_contrast)
        self._looks = edges_and_hues(self.picture)

    def drawing(self, hand: HandView, pose: Pose, draw: Draw) -> Drawing:
        """A thing at a pose, seen from a hand, as large as the reduced picture; the fingers are not drawn."""
        return drawn_whole(draw, pose, hand.camera, self._step)

    def fingers(self, hand: HandView) -> np.ndarray:
        """(h, w) bool, the area of the fingers."""
        mask = np.zeros(self.lab.shape[:2], np.uint8)
        for finger in np.split(hand.fingers, 2):
            outline = cv2.convexHull((hand.camera.project(finger) / self._step).astype(np.float32))
            cv2.fillConvexPoly(mask, outline.astype(np.int32), (1,))
        return mask > 0

    def lit(self, drawing: Drawing, hidden: np.ndarray) -> np.ndarray:
        """(h, w, 3) uint8, a drawing as bright as the picture is where it is covered and not hidden (h, w) bool."""
        return as_bright(drawing, self.picture, hidden, self._light).astype(np.uint8)

    def unlike(self, drawing: Drawing, hidden: np.ndarray, where: np.ndarray | None = None) -> float:
        """How unlike the picture is to a drawing of a thing on a plain table.

        Args:
            drawing: of the thing.
            hidden: (h, w) bool, what is not compared.
            where: (h, w) bool, what is compared alone.
        """
        expected = self.lit(drawing, hidden)
        expected[~drawing.covered] = self._behind(drawing, hidden)
        return self._apart(expected, hidden, where)

    def unlike_bare(self, drawing: Drawing, hidden: np.ndarray, where: np.ndarray | None = None) -> float:
        """The same of that plain table without the thing."""
        return self._apart(np.tile(self._behind(drawing, hidden), (*self.lab.shape[:2], 1)), hidden, where)

    def _behind(self, drawing: Drawing, hidden: np.ndarray) -> np.ndarray:
        """(3,) uint8, the colour beside a drawing; of all of the picture where that covers everything."""
        beside = ~drawing.covered & ~hidden
        return np.median(self.picture[beside if beside.any() else ~hidden], axis=0).astype(np.uint8)

    def _apart(self, expected: np.ndarray, hidden: np.ndarray, where: np.ndarray | None) -> float:
        expected[hidden] = self.picture[hidden]
        compared = ~hidden if where is None else where & ~hidden
        return unlike(self._looks[compared], edges_and_hues(expected)[compared])
