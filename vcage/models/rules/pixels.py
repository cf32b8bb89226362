"""Pixels of views: those that stand out of the table, those that differ, and where among them an object may be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.vision.colour import LabImage, distance, smoothed
from vcage.vision.detector import clean
from vcage.vision.object_templates import ObjectTemplate
from vcage.vision.pose_score import Fit, fit, from_pixels, refine
from vcage.vision.pose_search import search
from vcage.vision.protocols import View
from vcage.vision.table_model import fit_table


@dataclass(frozen=True)
class PixelSettings:
    """The comparison of pixels, and the search for an object among them.

    Args:
        changed_lab: least colour distance (CIELAB) between two pictures above which a pixel has changed.
        noise_factor, noisiest_lab: that limit grows with the noise: so many times the median distance between the
            pictures, but no farther.
        headings: headings around the circle that are tried where something stands.
        starts: how many more poses than things are refined.
        good_fit: goodness of fit where something stands that makes a search of the whole picture needless.
        filled_share: a place of which less stands out of the table is empty, though a thing may have its colour.
        steps: first steps along x, y (metres), angle (radians) and log scale with which a place is refined.
        rounds: how often it is refined.
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


PIXELS = PixelSettings()


def salience(picture: np.ndarray, background: np.ndarray | None) -> np.ndarray:
    """(H, W) in [0, 1], how surely a pixel is no table. Beside the empty table in the same light, what is merely darker
    counts in full: a grey basket on a grey table is."""
    if background is None:
        return fit_table(picture).salience
    return clean(changed(*(smoothed(p) for p in (background, picture)))).astype(np.float32)


def middles(masks: Sequence[np.ndarray]) -> np.ndarray:
    """(n, 2) pixels u, v."""
    return np.reshape([np.argwhere(mask).mean(axis=0)[::-1] + 0.5 for mask in masks], (-1, 2))


def places(image: LabImage, template: ObjectTemplate, standing: np.ndarray) -> Fit:
    """Poses at which an object may be, the best first: where something stands; anywhere, if it does not fit there."""
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
