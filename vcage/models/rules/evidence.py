"""What two top views show of one moved object: did it leave its place, and where is it now."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.geometry import Camera
from vcage.vision.colour import distance, palette, palette_distance, to_lab
from vcage.vision.detector import MIN_AREA, components, foreground
from vcage.vision.locate import (
    FINALISTS,
    FINE_HEADINGS,
    FINEST_HEADINGS,
    Sighting,
    pixels_per_metre,
    refine,
    search,
    templates,
)
from vcage.vision.protocols import Reference

CHANGED = 4.0
"""Least colour distance between the two pictures above which a pixel has changed."""

NOISE_FACTOR = 8.0
"""That limit grows with the noise: so many times the median distance between the pictures."""

ALIKE = 16.0
"""Colour distance to the object's palette below which a pixel may be the object's."""

NEARLY = 0.04
"""Places whose misfit is this close to the best are told apart by whether they changed."""

CLEARLY = 0.05
"""A receptacle is taken to have moved only when the new place is better by so much misfit."""

SIZE_FACTOR = 2.5
"""A region may be an object when its area is within this factor of the object's: shadows add, occlusion takes."""

SEARCH = 0.09
"""How far from its old place a receptacle is looked for, metres."""


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
        before, after, background: RGB of the same camera; the last shows the empty table, where there is one.
    """
    lab_before, lab_after = (to_lab(cv2.GaussianBlur(p, (3, 3), 0)) for p in (before, after))
    scale = pixels_per_metre(camera, table_height + moved.size[2] / 2)
    rim_scale = pixels_per_metre(camera, table_height + place.size[2])
    table = table_colour(lab_before)
    change = _changed(lab_before, lab_after)
    standing = [] if background is None else components(foreground(before, background), MIN_AREA * change.size)
    old_place, new_place = _receptacle(lab_before, lab_after, place, rim_scale, table, standing)
    standing += components(change & ~old_place.mask, MIN_AREA * change.size)
    old = _object(lab_before, moved, scale, table, change, old_place.mask, standing)
    unlike_before, unlike_after = (_unlikeness(lab, moved) for lab in (lab_before, lab_after))
    new = change & (unlike_after < ALIKE) & (unlike_after < unlike_before)
    area = float(old.mask.sum())
    within = _grown(new_place.mask, 0.006 * scale)
    elsewhere = new & ~within & ~_grown(old.mask, 0.004 * scale)
    return Evidence(
        left=float(change[old.mask].mean()),
        inside=float((new & within).sum()) / area,
        outside=_largest(elsewhere) / area,
        shifted=float(np.linalg.norm(new_place.centre - old_place.centre)) / scale,
        worse=new_place.misfit - old_place.misfit,
    )


def _changed(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """(H, W) bool: pixels that differ by more than noise, without specks."""
    away = distance(before, after)
    change = away > max(CHANGED, NOISE_FACTOR * float(np.median(away)))
    return cv2.morphologyEx(change.astype(np.uint8), cv2.MORPH_OPEN, np.ones((2, 2), np.uint8)).astype(bool)


def table_colour(lab: np.ndarray) -> np.ndarray:
    """(3,) the most frequent colour of the picture: the table fills most of a top view."""
    centres, _ = palette(lab[::4, ::4].reshape(-1, 3), count=5)
    return centres[0]


def _receptacle(
    before: np.ndarray,
    after: np.ndarray,
    place: Reference,
    scale: float,
    table: np.ndarray,
    standing: Sequence[np.ndarray],
) -> tuple[Sighting, Sighting]:
    """Where the receptacle was and is; where it was stays the answer unless another place fits clearly better."""
    around = _alike_in_size(standing, place, scale)
    old = search(before, place, scale, table, rim_only=True, around=around)[0]
    made = templates(place, scale, table, old.heading + FINE_HEADINGS, rim_only=True)
    still = refine(after, made[2:3], old.centre, reach=2)
    pixels = round(SEARCH * scale)
    rough = refine(after, made[1:4], old.centre, reach=pixels, step=6)
    near = templates(place, scale, table, rough.heading + FINEST_HEADINGS, rim_only=True)
    moved = refine(after, near, rough.centre, reach=4)
    return old, moved if moved.misfit < still.misfit - CLEARLY else still


def _object(
    lab: np.ndarray,
    moved: Reference,
    scale: float,
    table: np.ndarray,
    change: np.ndarray,
    place: np.ndarray,
    standing: Sequence[np.ndarray],
) -> Sighting:
    """Where the object was: among the places outside the receptacle that fit it nearly best, the one that changed most.

    What lies in the receptacle already was put there by earlier sub-tasks.
    """
    around = _alike_in_size(standing, moved, scale)
    found = [s for s in search(lab, moved, scale, table, count=FINALISTS, around=around) if s.mask.any()]
    found = [s for s in found if place[s.mask].mean() < 0.5] or found
    close = [s for s in found if s.misfit <= found[0].misfit + NEARLY]
    return max(close, key=lambda s: float(change[s.mask].mean()))


def _alike_in_size(masks: Sequence[np.ndarray], reference: Reference, scale: float) -> list[np.ndarray]:
    """(2,) middles of the regions whose area is about that of the object."""
    area = (reference.picture[..., 3] > 127).sum() * (reference.metres_per_pixel * scale) ** 2
    alike = [mask for mask in masks if area / SIZE_FACTOR < mask.sum() < area * SIZE_FACTOR]
    return [np.argwhere(mask).mean(axis=0)[::-1] + 0.5 for mask in alike]


def _unlikeness(lab: np.ndarray, reference: Reference) -> np.ndarray:
    """(H, W) colour distance of each pixel to the reference's main colours, in light or in shade."""
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
