"""Log odds that a known object stands at a candidate pose, from its fit, its features and the detector's labels."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.vision.pose_score import TERMS, Fit
from vcage.vision.protocols import Detection, Embedder


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
