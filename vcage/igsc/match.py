"""Correspondence between the source and the target picture (paper, section III-A3).

Every known object of the source picture is looked for among the detections of the target picture: greedily by
cosine similarity of features; then, for what is left, by name and feature together; what is still not found is
kept where it was, and says so. Pixels become world coordinates at the object's own height.
"""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np

from vcage.geometry import Camera, wrap_angle
from vcage.igsc.rotation import estimate_rotation, mask_centroid
from vcage.models.protocols import Detection, Embedder
from vcage.schema.matches import Match
from vcage.schema.scene import ObjectRecord, Scene

FALLBACK_THRESHOLD = 0.55
"""Smallest mean of name and feature similarity of a match by name."""
UNNAMED = 0.5
"""Name similarity of a detection without a label: it speaks neither for nor against."""
SMALLEST_MASK = 12
"""Pixels below which a mask says nothing about place and rotation."""
FOREGROUND_SIGMAS, FOREGROUND_MINIMUM = 5.0, 12.0
"""How far a pixel must stand out of the table: in deviations of its noise, and in grey levels at least."""

Pairs = dict[int, tuple[int, float]]
"""Source index → (detection index, score)."""


def resize_to(picture: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """The picture at (height, width) = ``size``: online editors may answer in another size than they were given."""
    height, width = size
    if picture.shape[:2] == (height, width):
        return picture
    shrinking = picture.shape[0] > height
    return cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA if shrinking else cv2.INTER_CUBIC)


def match_objects(
    scene: Scene,
    source: np.ndarray,
    segmentation: np.ndarray,
    target: np.ndarray,
    background: np.ndarray,
    detections: Sequence[Detection],
    embedder: Embedder,
    threshold: float,
) -> tuple[list[Match], list[tuple[float, float, float, float]]]:
    """Where every object of the scene is in the target picture.

    Args:
        scene: the known objects; their order is kept.
        source: (H, W, 3) uint8 top view of the scene.
        segmentation: (H, W) int, values of ``scene.segmentation_ids``.
        target: (H, W, 3) the edited picture, in the size of the source (:func:`resize_to`).
        background: (H, W, 3) the empty table; gives masks to detections that have none.
        detections: what was found in the target picture, in any order.
        embedder: makes the features.
        threshold: the paper's τ: smallest cosine similarity of a match by features.

    Returns:
        (matches, unclaimed): one match per object, and the boxes of detections that no object claimed.

    Raises:
        ValueError: the pictures differ in size.
    """
    _require_one_size(source, target, background, segmentation)
    masks = {o.id: segmentation == scene.segmentation_ids[o.id] for o in scene.objects}
    visible = [o for o in scene.objects if masks[o.id].sum() >= SMALLEST_MASK]
    targets = [with_mask(detection, target, background) for detection in detections]
    similarity = _similarity(embedder, source, [region_of(masks[o.id], o.phrase) for o in visible], target, targets)
    by_feature = greedy_pairs(similarity, threshold)
    by_name = _fallback_pairs(similarity, visible, targets, by_feature)
    camera = scene.top_camera.camera()
    found: dict[str, Match] = {}
    for method, pairs in (("feature", by_feature), ("name", by_name)):
        for index, (chosen, score) in pairs.items():
            record, detection = visible[index], targets[chosen]
            found[record.id] = Match(
                object=record.id,
                method=method,
                similarity=float(similarity[index, chosen]),
                confidence=float(np.clip(score, 0, 1)),
                box=tuple(float(x) for x in detection.box),
                **_recover(camera, record, source, masks[record.id], target, detection),
            )
    claimed = {chosen for pairs in (by_feature, by_name) for chosen, _ in pairs.values()}
    unclaimed = [tuple(float(x) for x in d.box) for k, d in enumerate(targets) if k not in claimed]
    seen = {o.id for o in visible}
    return [found.get(o.id) or _kept(o, o.id in seen) for o in scene.objects], unclaimed


def _require_one_size(*pictures: np.ndarray) -> None:
    sizes = [picture.shape[:2] for picture in pictures]
    if len(set(sizes)) > 1:
        raise ValueError(f"the pictures' sizes differ: {sizes}")


# --- regions and features ------------------------------------------------------------------------------


def region_of(mask: np.ndarray, label: str) -> Detection:
    """A known object's mask (H, W), not empty, as a region for the embedder."""
    v, u = np.nonzero(mask)
    return Detection((float(u.min()), float(v.min()), float(u.max() + 1), float(v.max() + 1)), mask, 1.0, label)


def with_mask(detection: Detection, picture: np.ndarray, background: np.ndarray) -> Detection:
    """The detection with a mask: its own, else what differs from the empty table inside its box, else the box."""
    if detection.mask is not None and detection.mask.sum() >= SMALLEST_MASK:
        return detection
    height, width = picture.shape[:2]
    u0, v0 = max(0, int(np.floor(detection.box[0]))), max(0, int(np.floor(detection.box[1])))
    u1, v1 = min(width, int(np.ceil(detection.box[2]))), min(height, int(np.ceil(detection.box[3])))
    window = np.s_[v0 : max(v1, v0 + 1), u0 : max(u1, u0 + 1)]
    foreground = _foreground(picture, background)[window]
    mask = np.zeros((height, width), dtype=bool)
    mask[window] = foreground if foreground.sum() >= SMALLEST_MASK else True
    return Detection(detection.box, mask, detection.score, detection.label)


def _foreground(picture: np.ndarray, background: np.ndarray) -> np.ndarray:
    """(H, W) bool: what stands out of the noise of the table, holes closed.

    An editor may change the whole picture a little; most of it is table, so the median is that change.
    """
    difference = cv2.GaussianBlur(cv2.absdiff(picture, background), (3, 3), 0).max(axis=2)
    middle = np.median(difference)
    noise = 1.4826 * np.median(np.abs(difference - middle))
    mask = (difference > middle + max(FOREGROUND_MINIMUM, FOREGROUND_SIGMAS * noise)).astype(np.uint8)
    return cv2.morphologyEx(mask, cv2.MORPH_CLOSE, np.ones((5, 5), np.uint8)) > 0


def _similarity(
    embedder: Embedder, source: np.ndarray, known: list[Detection], target: np.ndarray, found: list[Detection]
) -> np.ndarray:
    """(known, found) cosine similarities."""
    if not known or not found:
        return np.zeros((len(known), len(found)))
    return np.clip(embedder.embed(source, known) @ embedder.embed(target, found).T, -1, 1)


# --- pairing -------------------------------------------------------------------------------------------


def greedy_pairs(similarity: np.ndarray, threshold: float) -> Pairs:
    """Greedy one-to-one pairs of a (sources, detections) matrix, the best first, all above the threshold.

    Equal scores are taken in the order of the sources, then of the detections.
    """
    pairs: Pairs = {}
    taken: set[int] = set()
    columns = max(similarity.shape[1], 1)
    for flat in np.argsort(-similarity, axis=None, kind="stable"):
        index, chosen = divmod(int(flat), columns)
        if similarity[index, chosen] <= threshold:
            break
        if index not in pairs and chosen not in taken:
            pairs[index] = (chosen, float(similarity[index, chosen]))
            taken.add(chosen)
    return pairs


def _fallback_pairs(
    similarity: np.ndarray, objects: Sequence[ObjectRecord], found: Sequence[Detection], matched: Pairs
) -> Pairs:
    """Pairs among what ``matched`` left, by the mean of name and feature similarity."""
    scores = np.full(similarity.shape, -np.inf)
    taken = {chosen for chosen, _ in matched.values()}
    for index, record in enumerate(objects):
        for chosen, detection in enumerate(found):
            if index not in matched and chosen not in taken:
                name = UNNAMED if detection.label is None else name_similarity(detection.label, record.phrase)
                scores[index, chosen] = (name + similarity[index, chosen]) / 2
    return greedy_pairs(scores, FALLBACK_THRESHOLD)


def name_similarity(a: str, b: str) -> float:
    """How alike two names are, in [0, 1]: the larger of shared words (Dice) and shared letters in order."""
    a, b = " ".join(a.lower().split()), " ".join(b.lower().split())
    words_a, words_b = set(a.split()), set(b.split())
    if not words_a or not words_b:
        return 0.0
    dice = 2 * len(words_a & words_b) / (len(words_a) + len(words_b))
    return max(dice, difflib.SequenceMatcher(None, a, b).ratio())


# --- coordinates ---------------------------------------------------------------------------------------


def _recover(
    camera: Camera,
    record: ObjectRecord,
    source: np.ndarray,
    source_mask: np.ndarray,
    target: np.ndarray,
    detection: Detection,
) -> dict[str, Any]:
    """The fields of a match that say where the object went.

    A silhouette's centroid is close to the picture of the object's middle, so rays are met at half its height; the
    rest of the way from there to the object's origin is measured in the source and turns with the object.
    """
    turned, ncc = estimate_rotation(source, source_mask, target, detection.mask)
    middle = (record.aabb[0][2] + record.aabb[1][2]) / 2
    seen = camera.unproject(mask_centroid(source_mask), middle)[:2]
    offset = np.array(record.pose.position[:2]) - seen
    c, s = np.cos(turned), np.sin(turned)
    place = camera.unproject(mask_centroid(detection.mask), middle)[:2] + np.array([[c, -s], [s, c]]) @ offset
    yaw = float(wrap_angle(record.pose.pose().yaw + turned))
    return {"position": (float(place[0]), float(place[1])), "yaw": yaw, "turned": turned, "ncc": ncc}


def _kept(record: ObjectRecord, visible: bool) -> Match:
    why = "not found in the target picture" if visible else "hidden in the source picture"
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
        note=f"{why}; kept where it was",
    )
