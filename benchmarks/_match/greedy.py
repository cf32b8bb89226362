"""A baseline: the pairing of the paper's section III-A3, with any detector and embedder; none of our matching is used.

Each known object in turn takes the free detection with the most similar features, if their cosine is above τ. The rest
is paired by name and features together. The middle of the box becomes a place on the plane of the object's middle. The
turn is the best correlation of the upright crops over a grid of angles. The paper runs it on Grounding DINO and DINOv2.
"""

from __future__ import annotations

import difflib
from collections.abc import Sequence

import cv2
import numpy as np

from benchmarks._match.cases import Case
from vcage.base.geometry import wrap_angle
from vcage.schema.matches import Match, MatchMethod
from vcage.schema.scene import ObjectRecord
from vcage.vision.protocols import Detection, Detector, Embedder

THRESHOLD = 0.6
"""τ, for which the paper gives no value."""

NAME_THRESHOLD = 0.5
"""Least mean of name and feature similarity in the fallback."""

GRID = np.arange(-180, 180, 5)
"""Angles that are tried, degrees."""

CROP = 64
"""Side of the crops that are correlated, pixels."""


def match_greedily(case: Case, detector: Detector, embedder: Embedder) -> list[Match]:
    """A match for each object of the case's scene, in its order."""
    target = _in_size_of(case.target, case.source)
    detections = detector.detect(target, [o.phrase for o in case.scene.objects], case.background)
    known = [_region(case.segmentation == case.scene.segmentation_ids[o.id], o.phrase) for o in case.scene.objects]
    likeness = np.zeros((len(known), len(detections)))
    if detections:
        likeness = np.clip(embedder.embed(case.source, known) @ embedder.embed(target, detections).T, -1, 1)
    names = np.array([[_names_alike(region, detection) for detection in detections] for region in known])
    names = names.reshape(likeness.shape)
    pairs = _pair(likeness, THRESHOLD, {})
    by_feature = set(pairs)
    pairs = _pair((likeness + names) / 2, NAME_THRESHOLD, pairs)
    matches = []
    for index, record in enumerate(case.scene.objects):
        if index not in pairs:
            matches.append(_kept(record))
            continue
        chosen = pairs[index]
        method: MatchMethod = "feature" if index in by_feature else "name"
        score = float(likeness[index, chosen])
        matches.append(_match(case, record, known[index], target, detections[chosen], method, score))
    return matches


def _in_size_of(picture: np.ndarray, other: np.ndarray) -> np.ndarray:
    return cv2.resize(picture, other.shape[1::-1], interpolation=cv2.INTER_AREA)


def _region(mask: np.ndarray, label: str) -> Detection:
    v, u = np.nonzero(mask)
    return Detection((float(u.min()), float(v.min()), float(u.max() + 1), float(v.max() + 1)), mask, 1.0, label)


def _names_alike(known: Detection, found: Detection) -> float:
    """Similarity of two labels in [0, 1]; 0 where the detector gives none."""
    return difflib.SequenceMatcher(None, known.label or "", found.label).ratio() if found.label else 0.0


def _pair(scores: np.ndarray, threshold: float, pairs: dict[int, int]) -> dict[int, int]:
    """``pairs`` and, for each row in turn that has none, its best free column above the threshold."""
    pairs = dict(pairs)
    for index, line in enumerate(scores):
        free = [column for column in np.argsort(-line) if column not in pairs.values() and line[column] > threshold]
        if index not in pairs and free:
            pairs[index] = int(free[0])
    return pairs


def _match(
    case: Case,
    record: ObjectRecord,
    known: Detection,
    target: np.ndarray,
    found: Detection,
    method: MatchMethod,
    score: float,
) -> Match:
    turned, ncc = _turn(_crop(case.source, known.box), _crop(target, found.box, _side(known.box)))
    middle = (record.aabb[0][2] + record.aabb[1][2]) / 2
    pixel = np.array([(found.box[0] + found.box[2]) / 2, (found.box[1] + found.box[3]) / 2])
    place = case.scene.top_camera.camera().unproject(pixel, middle)
    return Match(
        object=record.id,
        method=method,
        similarity=score,
        confidence=float(np.clip(score, 0, 1)),
        box=found.box,
        position=(float(place[0]), float(place[1])),
        yaw=float(wrap_angle(record.pose.pose().yaw + turned)),
        turned=turned,
        ncc=ncc,
    )


def _side(box: Sequence[float]) -> float:
    return float(max(box[2] - box[0], box[3] - box[1]))


def _crop(picture: np.ndarray, box: Sequence[float], side: float | None = None) -> np.ndarray:
    """(CROP, CROP) grey float32 of the square of that side in pixels around a box's middle."""
    scale = CROP / (side or _side(box))
    u, v = (box[0] + box[2]) / 2, (box[1] + box[3]) / 2
    matrix = np.array([[scale, 0, CROP / 2 - scale * u], [0, scale, CROP / 2 - scale * v]])
    grey = cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY).astype(np.float32)
    return cv2.warpAffine(grey, matrix, (CROP, CROP), flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)


def _turn(source: np.ndarray, target: np.ndarray) -> tuple[float, float]:
    """(angle in radians, correlation) at which the target crop, turned back, is most like the source crop."""
    scores = []
    for degrees in GRID:
        matrix = cv2.getRotationMatrix2D(((CROP - 1) / 2, (CROP - 1) / 2), -float(degrees), 1.0)
        turned = cv2.warpAffine(target, matrix, (CROP, CROP), borderMode=cv2.BORDER_REPLICATE)
        scores.append(float(cv2.matchTemplate(turned, source, cv2.TM_CCOEFF_NORMED)[0, 0]))
    best = int(np.argmax(scores))
    return float(np.radians(GRID[best])), float(np.clip(scores[best], -1, 1))


def _kept(record: ObjectRecord) -> Match:
    return Match(
        object=record.id,
        method="kept",
        similarity=None,
        confidence=0.0,
        box=None,
        position=record.pose.position[:2],
        yaw=record.pose.pose().yaw,
        turned=0.0,
        ncc=None,
        note="no detection is like it",
    )
