"""What stands out in a view from above, where an object may be in it, and which pixels of two views differ."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from vcage.vision.colour import LabImage, distance, smoothed
from vcage.vision.detector import clean
from vcage.vision.object_templates import ObjectTemplate
from vcage.vision.pose_score import Fit, fit, from_pixels, refine
from vcage.vision.pose_search import search
from vcage.vision.protocols import View
from vcage.vision.table_model import fit_table

CHANGED = 4.0
"""Least colour distance between the two pictures above which a pixel has changed."""

NOISE_FACTOR, NOISIEST = 8.0, 12.0
"""That limit grows with the noise: so many times the median distance between the pictures, but no farther."""

HEADINGS, STARTS = 24, 8
"""Headings around the circle that are tried where something stands, and how many more poses than things are refined."""

GOOD_FIT = 0.75
"""Goodness of fit where something stands that makes a search of the whole picture needless."""

LEFT = 0.5
"""Share of the old outline of what was moved that must have changed."""

FILLED = 0.4
"""A place of which less stands out of the table is empty, though a thing may be of the table's colour."""

STEPS, ROUNDS = np.array([0.003, 0.003, 0.06, 0.015]), 8
"""First steps along x, y (metres), angle (radians) and log scale with which its new place is refined, and how often."""


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
    headings = np.linspace(0, 2 * np.pi, HEADINGS, endpoint=False)
    there = [(u, v, heading, 0.0) for u, v in standing for heading in headings]
    seen = fit(image, template, from_pixels(template, np.reshape(there, (-1, 4))))
    seen = seen.where(seen.term("fill") > FILLED).best_first()
    found = refine(image, template, seen.poses[: len(standing) + STARTS], STEPS, ROUNDS)
    if found.goodness.max(initial=0) < GOOD_FIT:
        # The middle of the picture as well: there is an answer for an empty table, if a poor one.
        middle = [image.lab.shape[1] / 2, image.lab.shape[0] / 2]
        anywhere = search(image, template, np.vstack([standing, middle]))
        found = found.with_those(anywhere.where(anywhere.term("fill") > FILLED))
        found = found if len(found.poses) else anywhere
    return found.best_first()


def changed(before: np.ndarray, after: np.ndarray, *, least: float = CHANGED) -> np.ndarray:
    """(H, W) bool: pixels that differ by more than noise and than a colour distance, without specks."""
    away = distance(before, after)
    change = away > np.clip(NOISE_FACTOR * float(np.median(away)), least, NOISIEST)
    return cv2.morphologyEx(change.astype(np.uint8), cv2.MORPH_OPEN, np.ones((2, 2), np.uint8)).astype(bool)


def changed_between(one: View, other: View) -> np.ndarray:
    """(H, W) bool: pixels that differ between two views of one camera."""
    return changed(smoothed(one.picture), smoothed(other.picture))


def share_of(change: np.ndarray, outline: np.ndarray) -> float:
    """Share of an outline (H, W) bool that changed; 0 of an empty one."""
    return float(change[outline].mean()) if outline.any() else 0.0
