"""Evidence of a hand that has closed on nothing: the camera on it sees the fingers touching."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.models.protocols import CriticQuestion
from vcage.models.rules.drawings import LightRange, as_bright
from vcage.sim.drawer import Drawing
from vcage.vision.colour import distance, to_lab

FINGER_LIGHT = LightRange((0.6, 1.3), (0.92, 1.09))


@dataclass(frozen=True)
class FingerSettings:
    """The comparison of a picture with drawings of the fingers, closed to wide open.

    Args:
        width_px: to which picture and drawings are reduced.
        alike_lab: colour distance up to which a pixel looks like a finger.
        light: in which the picture may be taken: a white thing is no finger in bright light.
        fewest_px: of a drawing of the fingers, reduced; one that shows fewer of them is not compared.
        closed_share: how much more of the closed fingers' area must look like them than of the area beside it, where
            the other drawings have theirs. Of 459 hands that held something, some of it as grey, none had above 89 %.
        apart_share: share of the fingers' area at a wider opening that looks like them, from which they are there.
    """

    width_px: int = 80
    alike_lab: float = 2.5
    light: LightRange = FINGER_LIGHT
    fewest_px: int = 40
    closed_share: float = 0.93
    apart_share: float = 0.5


SETTINGS = FingerSettings()


def closed_on_nothing(question: CriticQuestion, pictures: Mapping[str, np.ndarray]) -> bool:
    """True where a picture shows a hand whose fingers touch. Not told where the camera was moved from where the robot's
    file puts it, nor where what is behind the fingers has their colour.

    Args:
        question: draws the fingers.
        pictures: (H, W, 3) uint8 RGB by name of the camera, of one moment.
    """
    fingers = question.fingers
    return fingers is not None and any(_is_closed(shown, fingers(camera)) for camera, shown in pictures.items())


def _is_closed(picture: np.ndarray, drawings: Sequence[Drawing]) -> bool:
    """True where a picture (H, W, 3) shows the first of the drawings of fingers, rather than one of the others."""
    reduced = [_reduced(drawing) for drawing in drawings]
    small = [drawing for drawing in reduced if drawing.covered.sum() >= SETTINGS.fewest_px]
    if len(small) < 2 or small[0] is not reduced[0]:
        return False
    seen = cv2.resize(picture, small[0].covered.shape[::-1], interpolation=cv2.INTER_AREA)
    lab = to_lab(seen)
    anywhere = np.any([drawing.covered for drawing in small], axis=0)
    closed, *others = (_share(seen, lab, drawing, drawing.covered, anywhere & ~drawing.covered) for drawing in small)
    if closed < SETTINGS.closed_share or closed <= max(others):
        return False
    apart = [(drawing, drawing.covered & ~small[0].covered) for drawing in small[1:]]
    return all(_share(seen, lab, *there) < SETTINGS.apart_share for there in apart if there[1].any())


def _share(
    picture: np.ndarray, lab: np.ndarray, drawing: Drawing, where: np.ndarray, beside: np.ndarray | None = None
) -> float:
    """Share of a part (h, w) bool of a drawing of fingers that a picture (h, w, 3), in CIELAB too, looks like, less the
    same of the area beside it (h, w) bool."""
    own = to_lab(as_bright(drawing, picture, light=SETTINGS.light).astype(np.uint8))
    there = distance(lab[where], own[where]) < SETTINGS.alike_lab
    if beside is None:
        return float(there.mean())
    elsewhere = distance(lab[beside], np.median(own[drawing.covered], axis=0)) < SETTINGS.alike_lab
    return float(there.mean() - elsewhere.mean())


def _reduced(drawing: Drawing) -> Drawing:
    """A drawing as a picture is reduced; a pixel that the fingers cover in part is not covered."""
    height, width = drawing.covered.shape
    size = SETTINGS.width_px, round(height * SETTINGS.width_px / width)
    layers = drawing.picture, drawing.covered.astype(np.float32), drawing.depth
    picture, covered, depth = (cv2.resize(layer, size, interpolation=cv2.INTER_AREA) for layer in layers)
    return Drawing(picture, covered > 0.999, depth)
