"""Pixels of views: those that stand out, that changed, that look like an object; a shadow told from a thing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.vision.colour import LabImage, distance, palette, palette_distance, smoothed, to_lab
from vcage.vision.detector import clean
from vcage.vision.object_templates import ObjectTemplate
from vcage.vision.pose_score import Fit, fit, from_pixels, refine
from vcage.vision.pose_search import search
from vcage.vision.protocols import Reference, View
from vcage.vision.table_model import fit_table


@dataclass(frozen=True)
class PixelSettings:
    """The comparison of pixels, and the search for an object among them.

    Args:
        changed_lab: least colour distance (CIELAB) between two pictures above which a pixel has changed.
        noise_factor, noisiest_lab: that limit grows with the noise: factor of the median distance between the
            pictures, and largest limit.
        headings: headings around the circle that are tried where something stands.
        starts: how many more poses than things are refined.
        good_fit: goodness of fit at an occupied place that makes a search of the whole picture needless.
        filled_share: a place with a smaller share of object pixels is empty, though an object may have its colour.
        steps: first steps along x, y (metres), angle (radians) and log scale for refining a place.
        rounds: how often it is refined.
        alike_lab: colour distance to the palette of an object below which a pixel may be the object's.
        main_share: share of an object's pixels that a colour of its palette needs.
        shade: factors of L, a and b by which a colour changes in the shade.
        opaque: value of alpha, of 255, above which a reference shows the object.
    """

    changed_lab: float = 4.0
    noise_factor: float = 8.0
    noisiest_lab: float = 12.0
    headings: int = 24
    starts: int = 8
    good_fit: float = 0.75
    filled_share: float = 0.4
    steps: tuple[float, float, float, float] = (0.003, 0.003, 0.06, 0.015)
    rounds: int = 8
    alike_lab: float = 16.0
    main_share: float = 0.08
    shade: tuple[float, float, float] = (0.75, 0.85, 0.85)
    opaque: int = 200


PIXELS = PixelSettings()


def salience(picture: np.ndarray, background: np.ndarray | None) -> np.ndarray:
    """(H, W) in [0, 1], confidence that a pixel is not table. Beside the empty table in the same light, a darker pixel
    counts in full: a grey basket on a grey table is."""
    if background is None:
        return fit_table(picture).salience
    return clean(changed(*(smoothed(p) for p in (background, picture)))).astype(np.float32)


def middles(masks: Sequence[np.ndarray]) -> np.ndarray:
    """(n, 2) pixels u, v."""
    return np.reshape([np.argwhere(mask).mean(axis=0)[::-1] + 0.5 for mask in masks], (-1, 2))


def places(image: LabImage, template: ObjectTemplate, standing: np.ndarray) -> Fit:
    """Possible poses of an object, best first: at occupied places; anywhere, if it does not fit there."""
    headings = np.linspace(0, 2 * np.pi, PIXELS.headings, endpoint=False)
    there = [(u, v, heading, 0.0) for u, v in standing for heading in headings]
    seen = fit(image, template, from_pixels(template, np.reshape(there, (-1, 4))))
    seen = seen.where(seen.term("fill") > PIXELS.filled_share).best_first()
    found = refine(image, template, seen.poses[: len(standing) + PIXELS.starts], np.array(PIXELS.steps), PIXELS.rounds)
    if found.goodness.max(initial=0) < PIXELS.good_fit:
        # The middle of the picture as well: there is an answer for an empty table, if a poor one.
        middle = [image.lab.shape[1] / 2, image.lab.shape[0] / 2]
        anywhere = search(image, template, np.vstack([standing, middle]))
        found = found.with_those(anywhere.where(anywhere.term("fill") > PIXELS.filled_share))
        found = found if len(found.poses) else anywhere
    return found.best_first()


def changed(before: np.ndarray, after: np.ndarray, *, least: float = PIXELS.changed_lab) -> np.ndarray:
    """(H, W) bool: pixels that differ by more than noise and than a colour distance, without specks."""
    away = distance(before, after)
    change = away > np.clip(PIXELS.noise_factor * float(np.median(away)), least, PIXELS.noisiest_lab)
    return cv2.morphologyEx(change.astype(np.uint8), cv2.MORPH_OPEN, np.ones((2, 2), np.uint8)).astype(bool)


def changed_between(one: View, other: View) -> np.ndarray:
    """(H, W) bool: pixels that differ between two views of one camera."""
    return changed(smoothed(one.picture), smoothed(other.picture))


def share_of(change: np.ndarray, outline: np.ndarray) -> float:
    """Share of an outline (H, W) bool that changed; 0 of an empty one."""
    return float(change[outline].mean()) if outline.any() else 0.0


def looks_like(reference: Reference, lab: np.ndarray) -> np.ndarray:
    """(n,) bool: pixels (n, 3) that have one of a reference's main colours, in light or in shade."""
    if not len(lab):
        return np.zeros(0, bool)
    seen = reference.picture[..., 3] > PIXELS.opaque
    centres, shares = palette(to_lab(np.ascontiguousarray(reference.picture[..., :3]))[seen])
    centres = centres[shares > PIXELS.main_share]
    shaded = centres * np.array(PIXELS.shade)
    return palette_distance(lab, np.concatenate([centres, shaded])) < PIXELS.alike_lab


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
        blob_px: a patch nowhere as wide as this may be the edge of a nudged object.
    """

    grey: float = 0.16
    deepest: float = 1.5
    smooth: float = 0.1
    smooth_px: int = 5
    darkest: float = 0.001
    speck_px: int = 3
    strip_px: int = 5
    blob_px: int = 11


SHADOW = ShadowSettings()


@dataclass(frozen=True)
class Change:
    """Differences between two views.

    Args:
        all: (H, W) bool.
        things: (H, W) bool, changes other than shadows.
        lighter: (H, W) bool, changes that no new shadow makes: grey arms over a grey table look like one otherwise.
    """

    all: np.ndarray
    things: np.ndarray
    lighter: np.ndarray

    @classmethod
    def between(cls, one: View, other: View) -> Change:
        """Of two views of one camera in the same light."""
        smooth = [cv2.GaussianBlur(view.picture, (3, 3), 0) for view in (one, other)]
        change = changed(*map(to_lab, smooth))
        light = [np.log((picture.astype(np.float32) / 255) ** 2.2 + SHADOW.darkest) for picture in smooth]
        ratio = light[1] - light[0]
        mean = ratio.mean(axis=2)
        square = cv2.blur(mean * mean, (SHADOW.smooth_px,) * 2) - cv2.blur(mean, (SHADOW.smooth_px,) * 2) ** 2
        grey = (np.maximum.reduce(cv2.split(ratio)) - np.minimum.reduce(cv2.split(ratio)) < SHADOW.grey) & (
            np.abs(mean) < SHADOW.deepest
        )
        shade = grey & grown(
            grey & change & (square < SHADOW.smooth**2), SHADOW.smooth_px
        )  # a shadow's edge is not smooth
        things, lighter = (
            cv2.morphologyEx(some.astype(np.uint8), cv2.MORPH_OPEN, _square(SHADOW.speck_px)).astype(bool)
            for some in (change & ~shade, change & (mean > 0))
        )
        return cls(change, things, lighter)


def _square(side: int) -> np.ndarray:
    return np.ones((side, side), np.uint8)


def grown(mask: np.ndarray, pixels: float) -> np.ndarray:
    """(H, W) bool: a mask and its surroundings."""
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
    left = cv2.morphologyEx(left, cv2.MORPH_OPEN, _square(SHADOW.strip_px))
    count, labels, stats, _ = cv2.connectedComponentsWithStats(left, connectivity=8)
    stood = [cv2.connectedComponents((mask & ~explained).astype(np.uint8))[1] for mask in (before, after)]
    most = 0
    for number in range(1, count):
        here = labels == number
        near = grown(here, far)  # the strips at the old and the new place of an object both belong to it
        was, now = (np.argwhere(np.isin(there, np.setdiff1d(there[near], 0))) for there in stood)
        stays = len(was) and len(now) and np.linalg.norm(was.mean(axis=0) - now.mean(axis=0)) <= far
        thin = not cv2.morphologyEx(here.astype(np.uint8), cv2.MORPH_OPEN, _square(SHADOW.blob_px)).any()
        most = most if stays and thin else max(most, int(stats[number, cv2.CC_STAT_AREA]))
    return most
