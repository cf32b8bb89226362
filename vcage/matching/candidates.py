"""Candidate poses of every known object in the target picture, each with how well the object fits there."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from vcage.matching.proposals import propose
from vcage.vision.object_templates import Crop, View
from vcage.vision.photometry import pairs_of, recolour, refit
from vcage.vision.pose_score import Fit, fit, refine

PLACES, HEADINGS = 14, 3
"""Places that are proposed for an object, and headings at each."""

STARTS, KEPT = 8, 4
"""Poses that are refined roughly, and of those finely."""

ROUGH_STEPS, FINE_STEPS = np.array([3.0, 3.0, 0.12, 0.03]), np.array([1.0, 1.0, 0.05, 0.015])
"""First steps along x, y (pixels of the compared size), angle (radians) and log scale."""

ROUGH_ROUNDS, FINE_ROUNDS = 5, 7

FLIPS = np.array([np.pi / 2, np.pi, -np.pi / 2])
"""Turns of the best pose that are tried as well: objects are most alike to themselves half and quarter turned."""

TRUSTED = 0.74
"""Goodness of fit of an object whose colours say how the picture's colours changed."""


def find_candidates(target: View, source: View, crops: Sequence[Crop], also: np.ndarray) -> tuple[View, list[Fit]]:
    """Where each of the objects may be, the best first.

    Args:
        target, source: the pictures.
        crops: the objects, of the source.
        also: (n, 2) pixels where something was detected.

    Returns:
        (view, fits): the target in the colours of the source, and per object at most :data:`KEPT` poses.
    """
    covered = np.zeros(source.lab.shape[:2], bool)
    for crop in crops:
        covered |= crop.mask
    target = recolour(target, source, covered)
    # Objects are looked for beside each other: what takes the time lets go of the interpreter.
    with ThreadPoolExecutor(max(1, min(os.cpu_count() or 1, len(crops)))) as pool:
        rough = list(pool.map(lambda crop: _rough(target, source, crop, also), crops))
        again = _recoloured_by_matches(target, crops, rough)
        return again, list(pool.map(lambda crop, found: _fine(again, crop, found), crops, rough))


def _rough(target: View, source: View, crop: Crop, also: np.ndarray) -> Fit:
    first = fit(target, crop, propose(target, source, crop, PLACES, HEADINGS, also))
    best = np.argsort(-first.goodness, kind="stable")[:STARTS]
    return ranked(refine(target, crop, first.poses[best], _steps(crop, ROUGH_STEPS), ROUGH_ROUNDS))


def _recoloured_by_matches(target: View, crops: Sequence[Crop], found: Sequence[Fit]) -> View:
    pairs = [
        pairs_of(target, crop, fits.poses[0])
        for crop, fits in zip(crops, found, strict=True)
        if len(fits.poses) and fits.goodness[0] >= TRUSTED
    ]
    if not pairs:
        return target
    known, seen = (np.concatenate(part) for part in zip(*pairs, strict=True))
    return refit(target, known, seen)


def _fine(target: View, crop: Crop, found: Fit) -> Fit:
    if not len(found.poses):
        return found
    again = ranked(fit(target, crop, found.poses))
    apart = _distinct(again, crop)[:KEPT]
    flipped = np.repeat(again.poses[:1], len(FLIPS), axis=0)
    flipped[:, 2] += FLIPS
    fine = refine(target, crop, np.concatenate([again.poses[apart], flipped]), _steps(crop, FINE_STEPS), FINE_ROUNDS)
    return ranked(fine)


def _steps(crop: Crop, steps: np.ndarray) -> np.ndarray:
    return steps * [crop.step * crop.pixel, crop.step * crop.pixel, 1, 1]


def ranked(found: Fit) -> Fit:
    """The poses in the order of their goodness, the best first."""
    order = np.argsort(-found.goodness, kind="stable")
    return Fit(found.poses[order], found.terms[order])


def _distinct(found: Fit, crop: Crop) -> list[int]:
    """Indices of poses that are not nearly the same as a better one."""
    kept: list[int] = []
    for k, pose in enumerate(found.poses):
        away = found.poses[kept] - pose
        turned = np.abs((away[:, 2] + np.pi) % (2 * np.pi) - np.pi)
        if not np.any((np.hypot(away[:, 0], away[:, 1]) < 0.15 * np.sqrt(crop.area) * crop.pixel) & (turned < 0.25)):
            kept.append(k)
    return kept
