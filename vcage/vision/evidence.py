"""What speaks for a known object being at a candidate pose, as the logarithm of the odds that it is."""

from __future__ import annotations

import difflib
from collections.abc import Sequence

import numpy as np

from vcage.vision.detections import region_of
from vcage.vision.pose_score import TERMS, Fit
from vcage.vision.protocols import Detection, Embedder

FIT_WEIGHTS = {"colour": 5.0, "structure": 3.0, "fill": 4.0, "border": 13.0}
SIMILARITY_WEIGHT = 12.0
NAME_WEIGHT = 4.0
BIAS = -28.5
"""Weights of a logistic regression over candidates in pictures that were rendered and changed, whose truth is known;
the weight of the cosine is held below what fits one embedder best, as others spread less."""

SMALLEST_MASK = 12
"""Pixels below which a mask says nothing."""


def similarities(
    embedder: Embedder,
    source: np.ndarray,
    target: np.ndarray,
    known: Sequence[np.ndarray],
    masks: Sequence[Sequence[np.ndarray]],
) -> list[np.ndarray]:
    """Per object (k,) cosine similarities of the features where it is in the source and may be in the target.

    Args:
        embedder: makes the features.
        source, target: (H, W, 3) uint8.
        known: per object its mask (H, W) in the source.
        masks: per object those of its candidates in the target; the cosine is -1 where one lies outside the picture.
    """
    features = embedder.embed(source, [region_of(mask) for mask in known])
    flat = [region_of(m) for of_one in masks for m in of_one if m.sum() >= SMALLEST_MASK]
    found = iter(embedder.embed(target, flat) if flat else ())
    return [
        np.array([float(np.clip(next(found) @ row, -1, 1)) if m.sum() >= SMALLEST_MASK else -1.0 for m in of_one])
        for of_one, row in zip(masks, features, strict=True)
    ]


def log_odds(fit: Fit, similarity: np.ndarray, name: np.ndarray) -> np.ndarray:
    """(k,) of an object's candidates.

    Args:
        similarity: (k,) cosines of the features.
        name: (k,) how well the detector's label there fits, in [-1, 1]; 0 where it gave none.
    """
    weights = np.array([FIT_WEIGHTS[term] for term in TERMS])
    return BIAS + fit.terms @ weights + SIMILARITY_WEIGHT * similarity + NAME_WEIGHT * name


def _name_likeness(a: str, b: str) -> float:
    """How alike two names are, in [0, 1]: the larger of shared words (Dice) and shared letters in order."""
    a, b = " ".join(a.lower().split()), " ".join(b.lower().split())
    words_a, words_b = set(a.split()), set(b.split())
    if not words_a or not words_b:
        return 0.0
    dice = 2 * len(words_a & words_b) / (len(words_a) + len(words_b))
    return max(dice, difflib.SequenceMatcher(None, a, b).ratio())


def label_evidence(phrase: str, middles: np.ndarray, detections: Sequence[Detection]) -> np.ndarray:
    """(k,) in [-1, 1]: what the labels of the detections around pixels (k, 2) say about the object's name."""
    evidence = np.zeros(len(middles))
    labelled = [d for d in detections if d.label]
    for k, (u, v) in enumerate(middles):
        here = [d for d in labelled if d.box[0] <= u < d.box[2] and d.box[1] <= v < d.box[3]]
        if here:
            nearest = min(here, key=lambda d: np.hypot(u - (d.box[0] + d.box[2]) / 2, v - (d.box[1] + d.box[3]) / 2))
            evidence[k] = nearest.score * (2 * _name_likeness(nearest.label or "", phrase) - 1)
    return evidence
