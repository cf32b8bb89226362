"""What two top views show of one moved object: did it leave its place, and where is it now."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.geometry import Camera
from vcage.vision.colour import LabImage, distance, palette, palette_distance, to_lab
from vcage.vision.detector import MIN_AREA, clean, components
from vcage.vision.object_templates import ObjectTemplate, template_from_reference
from vcage.vision.pose_score import Fit, fit, from_pixels, mask_at, refine
from vcage.vision.pose_search import search
from vcage.vision.protocols import Reference
from vcage.vision.table_model import fit_table

CHANGED = 4.0
"""Least colour distance between the two pictures above which a pixel has changed."""

NOISE_FACTOR = 8.0
"""That limit grows with the noise: so many times the median distance between the pictures."""

ALIKE = 16.0
"""Colour distance to the object's palette below which a pixel may be the object's."""

HEADINGS, STARTS = 24, 8
"""Headings around the circle that are tried where something stands, and how many more poses than things are refined."""

GOOD_FIT = 0.75
"""Goodness of fit where something stands that makes a search of the whole picture needless."""

FILLED = 0.4
"""A place of which less stands out of the table is empty, though a thing may be of the table's colour."""

NEARLY = 0.04
"""Places whose goodness of fit is this close to the best are told apart by whether they changed."""

CLEARLY = 0.05
"""A receptacle is taken to have moved only when the new place is better by so much goodness of fit."""

SHELL = 0.35
"""Share of a receptacle's depth from its outline inwards that is compared: what lies in it hides its middle."""

SEARCH, SEARCH_STEP = 0.09, 0.006
"""How far from its old place a receptacle is looked for, and how densely, metres."""

STEPS, ROUNDS = np.array([0.003, 0.003, 0.06, 0.015]), 8
"""First steps along x, y (metres), angle (radians) and log scale with which its new place is refined, and how often."""


@dataclass(frozen=True)
class Evidence:
    """Measurements, all from pixels.

    Args:
        left: share of the object's old outline that has changed.
        inside: new pixels that look like the object within the receptacle's outline, over the object's area.
        outside: the same for the largest patch elsewhere on the table.
        shifted: how far the receptacle moved, metres.
        worse: by how much the receptacle's rim fits its reference worse than before, in [-1, 1].
    """

    left: float
    inside: float
    outside: float
    shifted: float
    worse: float


def gather(
    before: np.ndarray,
    after: np.ndarray,
    camera: Camera,
    table_height: float,
    moved: Reference,
    place: Reference,
    background: np.ndarray | None = None,
) -> Evidence:
    """Measure one sub-task: ``moved`` was to be put in or on ``place``.

    Args:
        before, after, background: (H, W, 3) uint8 RGB of the same camera; the last shows the empty table, where there
            is one.
        camera: took them.
        table_height: metres.
        moved, place: how the object and the receptacle look.
    """
    thing = template_from_reference(moved, camera, table_height)
    receptacle = template_from_reference(place, camera, table_height, shell=SHELL)
    image, image_after = (LabImage.of(p, salience(p, background)) for p in (before, after))
    lab_before, lab_after = (to_lab(cv2.GaussianBlur(p, (3, 3), 0)) for p in (before, after))
    change = changed(lab_before, lab_after)
    standing = components(image.salience > 0.5, MIN_AREA * change.size)
    old_place, new_place = _receptacle(image, image_after, receptacle, middles(standing))
    old_mask, new_mask = (mask_at(receptacle, fit.poses[0]) for fit in (old_place, new_place))
    standing += components(change & ~old_mask, MIN_AREA * change.size)
    old = _object(image, thing, change, old_mask, middles(standing))
    unlike_before, unlike_after = (_unlikeness(lab[change], moved) for lab in (lab_before, lab_after))
    new = np.zeros_like(change)
    new[change] = (unlike_after < ALIKE) & (unlike_after < unlike_before)
    area = float(old.sum())
    within = _grown(new_mask, 0.006 / receptacle.pixel)
    elsewhere = new & ~within & ~_grown(old, 0.004 / thing.pixel)
    return Evidence(
        left=float(change[old].mean()),
        inside=float((new & within).sum()) / area,
        outside=_largest(elsewhere) / area,
        shifted=float(np.linalg.norm(new_place.poses[0, :2] - old_place.poses[0, :2])),
        worse=float(old_place.goodness[0] - new_place.goodness[0]),
    )


def salience(picture: np.ndarray, background: np.ndarray | None) -> np.ndarray:
    """(H, W) in [0, 1], how surely a pixel is no table. Beside the empty table in the same light, what is merely darker
    counts in full: a grey basket on a grey table is."""
    if background is None:
        return fit_table(picture).salience
    return clean(changed(*(to_lab(cv2.GaussianBlur(p, (3, 3), 0)) for p in (background, picture)))).astype(np.float32)


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


def _receptacle(before: LabImage, after: LabImage, template: ObjectTemplate, standing: np.ndarray) -> tuple[Fit, Fit]:
    """Where the receptacle was and is, one pose each; where it was stays the answer unless another place fits clearly
    better."""
    old = places(before, template, standing).first
    still = refine(after, template, old.poses, STEPS / 3, ROUNDS // 2)
    offsets = np.arange(-SEARCH, SEARCH + SEARCH_STEP, SEARCH_STEP)
    around = old.poses + np.pad(np.stack(np.meshgrid(offsets, offsets), axis=-1).reshape(-1, 2), ((0, 0), (0, 2)))
    rough = fit(after, template, around).best_first()
    moved = refine(after, template, rough.poses[:4], STEPS, ROUNDS).best_first().first
    return old, moved if moved.goodness[0] > still.goodness[0] + CLEARLY else still


def _object(
    image: LabImage, template: ObjectTemplate, change: np.ndarray, place: np.ndarray, standing: np.ndarray
) -> np.ndarray:
    """(H, W) bool, where the object was: among the places outside the receptacle that fit it nearly best, the one that
    changed most.

    What lies in the receptacle already was put there by earlier sub-tasks.
    """
    found = places(image, template, standing)
    masks = [(goodness, mask_at(template, pose)) for goodness, pose in zip(found.goodness, found.poses)]
    seen = [(goodness, mask) for goodness, mask in masks if mask.any()]
    outside = [(goodness, mask) for goodness, mask in seen if place[mask].mean() < 0.5] or seen
    close = [mask for goodness, mask in outside if goodness >= outside[0][0] - NEARLY]
    return max(close, key=lambda mask: float(change[mask].mean()))


def changed(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """(H, W) bool: pixels that differ by more than noise, without specks."""
    away = distance(before, after)
    change = away > max(CHANGED, NOISE_FACTOR * float(np.median(away)))
    return cv2.morphologyEx(change.astype(np.uint8), cv2.MORPH_OPEN, np.ones((2, 2), np.uint8)).astype(bool)


def _unlikeness(lab: np.ndarray, reference: Reference) -> np.ndarray:
    """(n,) colour distance of each of the pixels (n, 3) to the reference's main colours, in light or in shade."""
    colours = to_lab(np.ascontiguousarray(reference.picture[..., :3]))[reference.picture[..., 3] > 200]
    centres, shares = palette(colours)
    centres = centres[shares > 0.08]
    shaded = centres * np.array([0.75, 0.85, 0.85])
    return palette_distance(lab, np.concatenate([centres, shaded]))


def _grown(mask: np.ndarray, radius: float) -> np.ndarray:
    side = 2 * max(1, round(radius)) + 1
    return cv2.dilate(mask.astype(np.uint8), cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side))).astype(bool)


def _largest(mask: np.ndarray) -> float:
    """Area of the largest connected patch, pixels."""
    _, _, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    return float(stats[1:, cv2.CC_STAT_AREA].max(initial=0))
