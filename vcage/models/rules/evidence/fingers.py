"""Evidence of whether a hand holds something: the camera on it sees its fingers touching, or apart.

A hand that holds something keeps closing, so its fingers touch once the object is gone. Fingers that are apart hold
something or were never closed, so what is between them must be checked, too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import cv2
import numpy as np

from vcage.models.protocols import CriticQuestion
from vcage.models.rules.drawings import LightRange, brightness
from vcage.sim.drawer import Drawing
from vcage.vision.colour import distance, to_lab

FINGER_LIGHT = LightRange((0.6, 1.3), (0.92, 1.09))


@dataclass(frozen=True)
class FingerSettings:
    """The comparison of a picture with drawings of the fingers, closed to wide open.

    Args:
        width_px: to which picture and drawings are reduced.
        light: in which the picture may be taken: a white thing is no finger in bright light.
        fewest_px: of a drawing of the fingers, reduced; one that shows fewer of them is not compared.
        alike_lab: colour distance up to which a pixel looks like touching fingers.
        touch_share: share of the area of touching fingers that must look like them. Of 586 pictures of hands that held
            something, some as grey as the fingers, none reached 98 %; of 24 hands that had lost their object, 20 did,
            and 2 of the others were open.
        beside_share: share of the area that the fingers cover at another opening, outside that of touching ones, from
            which they may be at that opening instead.
        roughly_lab, astray_px, apart_share: the fingers do not touch if less than this share of the area looks like
            touching fingers, even within this larger colour distance and with the drawing shifted by so many reduced
            pixels.
        seen_share: how much more of their area at another opening must then look like them, within ``roughly_lab``,
            than of the area beside it, where the other drawings have theirs, for them to be seen apart: what they hold
            hides a part of them.
    """

    width_px: int = 80
    light: LightRange = FINGER_LIGHT
    fewest_px: int = 40
    alike_lab: float = 2.5
    touch_share: float = 0.98
    beside_share: float = 0.6
    roughly_lab: float = 4.0
    astray_px: int = 3
    apart_share: float = 0.5
    seen_share: float = 0.2


SETTINGS = FingerSettings()


def fingers_touch(question: CriticQuestion, pictures: Mapping[str, np.ndarray]) -> bool | None:
    """True if a picture shows touching fingers, False if all show them apart, else None: what is behind them has their
    colour, too little of them is seen, it lies between the two, or there are no drawings or pictures.

    Valid only for a camera within about a centimetre of where the robot's file puts it; this is not checked.

    Args:
        question: draws the fingers.
        pictures: (H, W, 3) uint8 RGB by name of the camera, of one moment.
    """
    if question.fingers is None:
        return None
    told = [_touch(shown, question.fingers(camera)) for camera, shown in pictures.items()]
    if True in told:
        return True
    return None if None in told or not told else False


def _touch(picture: np.ndarray, drawings: Sequence[Drawing]) -> bool | None:
    """The same of one picture (H, W, 3), with drawings of its hand's fingers."""
    reduced = [_reduced(drawing) for drawing in drawings]
    small = [drawing for drawing in reduced if drawing.covered.sum() >= SETTINGS.fewest_px]
    if len(small) < 2 or small[0] is not reduced[0]:
        return None
    seen = cv2.resize(picture, small[0].covered.shape[::-1], interpolation=cv2.INTER_AREA)
    closed, *others = small
    light = brightness(closed, seen, light=SETTINGS.light)
    if _share(seen, closed, closed.covered, light, SETTINGS.alike_lab) >= SETTINGS.touch_share:
        return True if _beside_share(seen, closed, others, light) < SETTINGS.beside_share else None
    if _rough_share(seen, closed) >= SETTINGS.apart_share:
        return None
    anywhere = np.any([drawing.covered for drawing in small], axis=0)
    shown = max(_shown_share(seen, drawing, anywhere) for drawing in others)
    return False if shown >= SETTINGS.seen_share else None


def _share(picture: np.ndarray, drawing: Drawing, where: np.ndarray, light: np.ndarray, alike_lab: float) -> float:
    """Share of a part (h, w) bool of a drawing, in some light (3,), that a picture (h, w, 3) looks like."""
    own = np.clip(drawing.picture[where].astype(np.float32) * light, 0, 255).astype(np.uint8)
    return float((distance(to_lab(picture[where][None])[0], to_lab(own[None])[0]) < alike_lab).mean())


def _beside_share(picture: np.ndarray, closed: Drawing, others: Sequence[Drawing], light: np.ndarray) -> float:
    """Largest share of the area of fingers at another opening, beside that of touching ones, that looks like them."""
    beside = [(drawing, drawing.covered & ~closed.covered) for drawing in others]
    return max((_share(picture, *there, light, SETTINGS.alike_lab) for there in beside if there[1].any()), default=1.0)


def _shown_share(picture: np.ndarray, drawing: Drawing, anywhere: np.ndarray) -> float:
    """Share of the fingers of a drawing that a picture looks like, less the same of the area beside them where fingers
    may be (h, w) bool."""
    light, beside = brightness(drawing, picture, light=SETTINGS.light), anywhere & ~drawing.covered
    if not beside.any():
        return 0.0  # nothing to tell the fingers from
    own = np.clip(np.median(drawing.picture[drawing.covered], axis=0) * light, 0, 255).astype(np.uint8)
    elsewhere = distance(to_lab(picture[beside][None])[0], to_lab(own[None, None])[0, 0]) < SETTINGS.roughly_lab
    return _share(picture, drawing, drawing.covered, light, SETTINGS.roughly_lab) - float(elsewhere.mean())


def _rough_share(picture: np.ndarray, closed: Drawing) -> float:
    """Largest share of the touching fingers, at their place or somewhat beside it, that a picture looks like."""
    far, (height, width) = SETTINGS.astray_px, closed.covered.shape
    around = np.pad(picture, ((far, far), (far, far), (0, 0)), mode="edge")
    found = []
    for down, across in product((0, far, 2 * far), repeat=2):
        moved = around[down : down + height, across : across + width]
        light = brightness(closed, moved, light=SETTINGS.light)
        found.append(_share(moved, closed, closed.covered, light, SETTINGS.roughly_lab))
    return max(found)


def _reduced(drawing: Drawing) -> Drawing:
    """A drawing as a picture is reduced; a pixel that the fingers cover in part is not covered."""
    height, width = drawing.covered.shape
    size = SETTINGS.width_px, round(height * SETTINGS.width_px / width)
    layers = drawing.picture, drawing.covered.astype(np.float32), drawing.depth
    picture, covered, depth = (cv2.resize(layer, size, interpolation=cv2.INTER_AREA) for layer in layers)
    return Drawing(picture, covered > 0.999, depth)
