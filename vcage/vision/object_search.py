"""Candidate poses of every known object in the edited picture, each with the evidence that the object is there."""

from __future__ import annotations

import difflib
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from vcage.schema.scene import ObjectRecord
from vcage.vision.colour import LabImage, transfer_pixelwise
from vcage.vision.object_templates import ObjectTemplate, template_of
from vcage.vision.observation import LEAST_MASK_PX, Observation
from vcage.vision.pose_score import TERMS, Fit, mask_at, middles, pixels_of, placed, turned_towards
from vcage.vision.pose_search import search_finely, search_roughly
from vcage.vision.protocols import Detection, Embedder

TRUSTED_GOODNESS = 0.74
"""Least goodness of fit of an object by whose colours the colours of the whole picture are corrected."""


@dataclass(frozen=True)
class Candidates:
    """Possible poses of one object, the best fit first.

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
    """The picture with its colours fitted to those of the surely found objects."""
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


@dataclass(frozen=True)
class OddsWeights:
    """Weights of a logistic regression over candidates in rendered and changed pictures whose truth is known.

    Args:
        colour, structure, fill, border: of the terms of a fit.
        similarity: of the cosine of the features; below the best fit to one embedder, as others spread less.
        label: of the support from the detector's labels.
        bias: constant.
    """

    colour: float = 5.0
    structure: float = 3.0
    fill: float = 4.0
    border: float = 13.0
    similarity: float = 12.0
    label: float = 4.0
    bias: float = -28.5


WEIGHTS = OddsWeights()


def log_odds(fit: Fit, similarity: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """(k,) log odds of an object's candidates.

    Args:
        fit: of the object at k poses.
        similarity: (k,) cosines of the features.
        labels: (k,) support from the detector's labels, in [-1, 1]; 0 where there was none.
    """
    terms = fit.terms @ np.array([getattr(WEIGHTS, term) for term in TERMS])
    return WEIGHTS.bias + terms + WEIGHTS.similarity * similarity + WEIGHTS.label * labels


def feature_similarities(
    embedder: Embedder,
    source: tuple[np.ndarray, Sequence[np.ndarray]],
    target: tuple[np.ndarray, Sequence[Sequence[np.ndarray]]],
    least_px: int,
) -> list[np.ndarray]:
    """Per object (k,) cosines between its features in the source and at its candidates in the target.

    Args:
        embedder: makes the features.
        source: (H, W, 3) uint8, and per object its mask (H, W).
        target: (H, W, 3) uint8, and per object the masks of its candidates.
        least_px: area of a mask below which the cosine is -1: the candidate lies outside the picture.
    """
    features = embedder.embed(source[0], [Detection.of_mask(mask) for mask in source[1]])
    large = [mask for masks in target[1] for mask in masks if mask.sum() >= least_px]
    found = iter(embedder.embed(target[0], [Detection.of_mask(mask) for mask in large]) if large else ())
    return [
        np.array([float(np.clip(next(found) @ row, -1, 1)) if m.sum() >= least_px else -1.0 for m in masks])
        for masks, row in zip(target[1], features, strict=True)
    ]


def label_evidence(phrase: str, middles: np.ndarray, detections: Sequence[Detection]) -> np.ndarray:
    """(k,) in [-1, 1]: support for an object's name from the labels of the detections around pixels (k, 2)."""
    evidence = np.zeros(len(middles))
    labelled = [d for d in detections if d.label]
    for k, (u, v) in enumerate(middles):
        here = [d for d in labelled if d.box[0] <= u < d.box[2] and d.box[1] <= v < d.box[3]]
        if here:
            nearest = min(here, key=lambda d: np.hypot(u - d.centre[0], v - d.centre[1]))
            evidence[k] = nearest.score * (2 * _name_likeness(nearest.label or "", phrase) - 1)
    return evidence


def _name_likeness(a: str, b: str) -> float:
    """Likeness of two names in [0, 1]: the larger of shared words (Dice) and shared letters in order."""
    a, b = " ".join(a.lower().split()), " ".join(b.lower().split())
    words_a, words_b = set(a.split()), set(b.split())
    if not words_a or not words_b:
        return 0.0
    dice = 2 * len(words_a & words_b) / (len(words_a) + len(words_b))
    return max(dice, difflib.SequenceMatcher(None, a, b).ratio())
