"""Candidate poses of every known object in the target picture, each with how well the object fits there."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from vcage.vision.colour import LabImage, transfer_pixelwise, transfer_statistics
from vcage.vision.object_templates import ObjectTemplate
from vcage.vision.pose_score import Fit, pixels_of, placed, turned_towards
from vcage.vision.pose_search import search_finely, search_roughly

TRUSTED = 0.74
"""Goodness of fit of an object whose colours say how the picture's colours changed."""


def find_candidates(
    target: LabImage, source: LabImage, templates: Sequence[ObjectTemplate], also: np.ndarray
) -> tuple[LabImage, list[Fit]]:
    """Where each of the objects may be, the best first.

    Args:
        target, source: the pictures.
        templates: the objects, of the source.
        also: (n, 2) pixels where something was detected.

    Returns:
        (image, fits): the target in the colours of the source, and per object a few poses.
    """
    covered = np.zeros(source.lab.shape[:2], bool)
    for template in templates:
        covered |= template.mask
    target = transfer_statistics(target, source, covered)
    # Objects are looked for beside each other: what takes the time lets go of the interpreter.
    with ThreadPoolExecutor(max(1, min(os.cpu_count() or 1, len(templates)))) as pool:
        rough = list(pool.map(lambda template: search_roughly(target, template, also), templates))
        again = _recoloured_by_matches(target, templates, rough)
        return again, list(pool.map(lambda template, found: search_finely(again, template, found), templates, rough))


def _recoloured_by_matches(target: LabImage, templates: Sequence[ObjectTemplate], found: Sequence[Fit]) -> LabImage:
    pairs = [
        _pairs(target, template, fits.poses[0])
        for template, fits in zip(templates, found, strict=True)
        if len(fits.poses) and fits.goodness[0] >= TRUSTED
    ]
    if not pairs:
        return target
    known, seen = (np.concatenate(part) for part in zip(*pairs, strict=True))
    return transfer_pixelwise(target, known, seen)


def _pairs(image: LabImage, template: ObjectTemplate, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) Lab of the points of a template that show at a pose (4,), and of the target where they are."""
    at = placed(template, pose[None], template.surface.points)
    shown = turned_towards(template, pose[None], at, template.surface.facing)[0] >= 0
    return template.surface.colours[shown], image.sample(pixels_of(template.camera, at), template.step)[0, shown, :3]
