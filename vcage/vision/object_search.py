"""Candidate poses of every known object in the edited picture, each with the evidence that the object is there."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from vcage.schema.scene import ObjectRecord
from vcage.vision.candidate_odds import feature_similarities, label_evidence, log_odds
from vcage.vision.colour import LabImage, transfer_pixelwise
from vcage.vision.object_templates import ObjectTemplate, template_of
from vcage.vision.observation import LEAST_MASK_PX, Observation
from vcage.vision.pose_score import Fit, mask_at, middles, pixels_of, placed, turned_towards
from vcage.vision.pose_search import search_finely, search_roughly
from vcage.vision.protocols import Embedder

TRUSTED_GOODNESS = 0.74
"""Least goodness of fit of an object by whose colours the colours of the whole picture are corrected."""


@dataclass(frozen=True)
class Candidates:
    """Poses at which one object may stand, the best fit first.

    Args:
        record: the object.
        template: its template.
        fit: k poses.
        masks: k times (H, W) bool, its outline at each pose.
        similarity: (k,) cosines of the features.
        labels: (k,) support from the detector's labels, in [-1, 1].
    """

    record: ObjectRecord
    template: ObjectTemplate
    fit: Fit
    masks: list[np.ndarray]
    similarity: np.ndarray
    labels: np.ndarray

    @property
    def odds(self) -> np.ndarray:
        """(k,) log odds that the object is at each pose."""
        return log_odds(self.fit, self.similarity, self.labels)


def find_candidates(observation: Observation, embedder: Embedder) -> tuple[Observation, list[Candidates]]:
    """Search the edited picture for all objects that the source shows.

    Returns:
        (observation, candidates): the observation with colours corrected by the objects that were found, and one
        entry per visible object, in the scene's order.
    """
    records = observation.visible
    if not records:
        return observation, []
    camera = observation.camera
    templates = [
        template_of(observation.source_lab, observation.masks[o.id], camera, np.array(o.aabb), o.pose.position[:2])
        for o in records
    ]
    observation, fits = _searched(observation, templates)
    outlines = [[mask_at(t, pose) for pose in fit.poses] for t, fit in zip(templates, fits, strict=True)]
    known = [observation.masks[o.id] for o in records]
    target = observation.target.rgb(), outlines
    likeness = feature_similarities(embedder, (observation.source, known), target, LEAST_MASK_PX)
    labels = [
        label_evidence(record.phrase, middles(template, fit.poses), observation.detections)
        for record, template, fit in zip(records, templates, fits, strict=True)
    ]
    rows = zip(records, templates, fits, outlines, likeness, labels, strict=True)
    return observation, [Candidates(*row) for row in rows]


def _searched(observation: Observation, templates: Sequence[ObjectTemplate]) -> tuple[Observation, list[Fit]]:
    """The observation in corrected colours, and a few poses per object: searched roughly, then finely."""
    detected_at = observation.detected_at
    # One thread per object: the numerical libraries release the interpreter lock.
    with ThreadPoolExecutor(max(1, min(os.cpu_count() or 1, len(templates)))) as pool:
        rough = list(pool.map(lambda template: search_roughly(observation.target, template, detected_at), templates))
        target = _recoloured(observation.target, templates, rough)
        fine = list(pool.map(lambda template, found: search_finely(target, template, found), templates, rough))
    return replace(observation, target=target), fine


def _recoloured(target: LabImage, templates: Sequence[ObjectTemplate], found: Sequence[Fit]) -> LabImage:
    """The picture with its colours fitted to those of the objects that were found surely."""
    pairs = [
        _colour_pairs(target, template, fits.poses[0])
        for template, fits in zip(templates, found, strict=True)
        if len(fits.poses) and fits.goodness[0] >= TRUSTED_GOODNESS
    ]
    if not pairs:
        return target
    known, seen = (np.concatenate(part) for part in zip(*pairs, strict=True))
    return transfer_pixelwise(target, known, seen)


def _colour_pairs(image: LabImage, template: ObjectTemplate, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) Lab of the points of a template that show at a pose (4,), and of the picture at the same points."""
    at = placed(template, pose[None], template.surface.points)
    shown = turned_towards(template, pose[None], at, template.surface.facing)[0] >= 0
    return template.surface.colours[shown], image.sample(pixels_of(template.camera, at), template.step)[0, shown, :3]
