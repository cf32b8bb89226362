"""Changes between two views of one camera; a shadow is told apart from a thing."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from vcage.models.rules.pixels import changed
from vcage.vision.colour import to_lab
from vcage.vision.protocols import View


@dataclass(frozen=True)
class ShadowSettings:
    """Limits that tell a shadow from a thing, and sizes too small to be one.

    Args:
        grey: the amounts by which a shadow changes the logarithms of the three colours differ by less than this.
        deepest: and are no larger.
        smooth, smooth_px: standard deviation of that logarithm within a square of so many pixels that only edges and
            textures exceed.
        darkest: light, of 1 for white, that is added to all, for black has no logarithm; more of it tints shadows on
            dark wood.
        speck_px, strip_px: narrower strips than this are the edges of shadows; and where there should be none.
        blob_px: what is nowhere as wide as this may be the edge of what was nudged.
    """

    grey: float = 0.16
    deepest: float = 1.5
    smooth: float = 0.1
    smooth_px: int = 5
    darkest: float = 0.001
    speck_px: int = 3
    strip_px: int = 5
    blob_px: int = 11


SETTINGS = ShadowSettings()


@dataclass(frozen=True)
class Change:
    """Differences between two views.

    Args:
        all: (H, W) bool.
        things: (H, W) bool, what is no shadow.
    """

    all: np.ndarray
    things: np.ndarray

    @classmethod
    def between(cls, one: View, other: View) -> Change:
        """Of two views of one camera in the same light."""
        smooth = [cv2.GaussianBlur(view.picture, (3, 3), 0) for view in (one, other)]
        change = changed(*map(to_lab, smooth))
        light = [np.log((picture.astype(np.float32) / 255) ** 2.2 + SETTINGS.darkest) for picture in smooth]
        ratio = light[1] - light[0]
        mean = ratio.mean(axis=2)
        square = cv2.blur(mean * mean, (SETTINGS.smooth_px,) * 2) - cv2.blur(mean, (SETTINGS.smooth_px,) * 2) ** 2
        grey = (np.maximum.reduce(cv2.split(ratio)) - np.minimum.reduce(cv2.split(ratio)) < SETTINGS.grey) & (
            np.abs(mean) < SETTINGS.deepest
        )
        shade = grey & grown(
            grey & change & (square < SETTINGS.smooth**2), SETTINGS.smooth_px
        )  # a shadow's edge is not smooth
        things = (change & ~shade).astype(np.uint8)
        return cls(change, cv2.morphologyEx(things, cv2.MORPH_OPEN, _square(SETTINGS.speck_px)).astype(bool))


def _square(side: int) -> np.ndarray:
    return np.ones((side, side), np.uint8)


def grown(mask: np.ndarray, pixels: float) -> np.ndarray:
    """(H, W) bool: a mask and what is around it."""
    side = 2 * max(1, round(pixels)) + 1
    return cv2.dilate(mask.astype(np.uint8), cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side))).astype(bool)


def displaced(change: Change, explained: np.ndarray, before: np.ndarray, after: np.ndarray, far: float) -> int:
    """Pixels of the largest thing that has come, gone or moved where nothing is explained.

    Args:
        change: of two views.
        explained: (H, W) bool, where they may differ.
        before, after: (H, W) bool, where things stand in them.
        far: a thing that moved less stands where it stood, pixels.
    """
    left = (change.things & ~explained).astype(np.uint8)
    left = cv2.morphologyEx(left, cv2.MORPH_OPEN, _square(SETTINGS.strip_px))
    count, labels, stats, _ = cv2.connectedComponentsWithStats(left, connectivity=8)
    stood = [cv2.connectedComponents((mask & ~explained).astype(np.uint8))[1] for mask in (before, after)]
    most = 0
    for number in range(1, count):
        here = labels == number
        near = grown(here, far)  # the strip that a thing left and the one that it came to are both of it
        was, now = (np.argwhere(np.isin(there, np.setdiff1d(there[near], 0))) for there in stood)
        stays = len(was) and len(now) and np.linalg.norm(was.mean(axis=0) - now.mean(axis=0)) <= far
        thin = not cv2.morphologyEx(here.astype(np.uint8), cv2.MORPH_OPEN, _square(SETTINGS.blob_px)).any()
        most = most if stays and thin else max(most, int(stats[number, cv2.CC_STAT_AREA]))
    return most
