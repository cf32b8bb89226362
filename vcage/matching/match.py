"""Correspondence between the source and the target picture (paper, section III-A3).

As in the paper: detections of the target picture, features of regions, pairs, coordinates by the inverse projection,
rotation by normalised cross-correlation. What differs is the order. Detections of an edited picture merge what touches,
miss what is pale and follow shadows, while every known object has a crop of its own; so each crop is laid over the
target at every place and heading first, the detections only say where to look as well and what things are called, and
features, correlation, colours and outline together decide. Which way an object faces is settled last, where it is:
by drawings of its model if it has one, by its crop if not.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.geometry import Camera
from vcage.base.workers import one_blas_thread
from vcage.matching.assignment import Chosen, assign
from vcage.matching.candidates import find_candidates
from vcage.matching.evidence import (
    SMALLEST_MASK,
    log_odds,
    name_evidence,
    recoloured,
    region_of,
    similarities,
)
from vcage.matching.heading_by_crop import settle, softened
from vcage.matching.heading_by_render import settle_drawn
from vcage.matching.identical_objects import settle_twins
from vcage.matching.unmatched import kept
from vcage.schema.matches import Match
from vcage.schema.plan import LayoutPlan, Plan
from vcage.schema.scene import ObjectRecord, Scene, Table
from vcage.sim.drawer import Drawer
from vcage.vision.object_templates import Crop, View, crop_of
from vcage.vision.pose_score import TERMS, Fit, fit, mask_at, middles
from vcage.vision.protocols import Detection, Detector, Embedder
from vcage.vision.recover import heading_of, smallest_turn
from vcage.vision.register import register
from vcage.vision.table_model import fit_table

DOUBT = 0.38
"""Confidence below which a match is not made."""

MOST_DETECTIONS = 200
"""Detections that are looked at, the surest first."""

TABLE_EDGE = 4
"""Pixels along the table's edge that are left out: an edited picture may bend it."""

UNCLAIMED_SHARE = 0.5
"""A detected box of which more is table and no matched object is unclaimed."""

LEAST_UNCLAIMED = 80
"""Pixels of a part of a detection that matched objects leave over, for it to be something."""

Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class ScenePictures:
    """The pictures that were taken of a scene.

    Args:
        source: (H, W, 3) uint8 top view.
        segmentation: (H, W) int, values of ``scene.segmentation_ids``.
        background: (H, W, 3) uint8, the same view of the empty table.
    """

    source: np.ndarray
    segmentation: np.ndarray
    background: np.ndarray


@dataclass(frozen=True)
class MatchResult:
    """What the target picture shows of the scene.

    Args:
        matches: one per object, in the scene's order.
        unclaimed: boxes of detections that no object claimed, pixels.
        picture: (H, W, 3) uint8, the target in the source's frame.
        notes: what was strange about the picture, in sentences.
    """

    matches: list[Match]
    unclaimed: list[Box]
    picture: np.ndarray
    notes: list[str]


@dataclass(frozen=True)
class _Known:
    """The objects that the source picture shows, and what was found of them: the target in the source's colours, and
    the source as soft as the target."""

    target: View
    source: View
    records: list[ObjectRecord]
    crops: list[Crop]
    fits: list[Fit]
    masks: list[list[np.ndarray]]
    similarity: list[np.ndarray]
    names: list[np.ndarray]
    odds: list[np.ndarray]


@one_blas_thread()
def match_picture(
    scene: Scene,
    plan: LayoutPlan | Plan | None,
    pictures: ScenePictures,
    target: np.ndarray,
    detector: Detector,
    embedder: Embedder,
    *,
    threshold: float = 0.6,
    symmetry: Mapping[str, int] | None = None,
    drawer: Drawer | None = None,
) -> MatchResult:
    """Where every object of the scene is in the target picture.

    Args:
        scene: the known objects; their order is kept.
        plan: says where objects go that the picture does not show; None keeps them where they were.
        pictures: of the scene.
        target: what an image model answered: any size, grey, RGBA, cropped (:func:`vcage.vision.register.register`).
        detector: says where to look as well, what things are called, and what is there that nobody knows.
        embedder: makes the features.
        threshold: the paper's τ: smallest cosine similarity of a match by features. Below it an object is matched only
            by its name or by its picture, and says so.
        symmetry: object id → n-fold rotational symmetry seen from above (0: round); 1 where it is not given.
        drawer: draws objects of the scene; headings of those that it has no model of are settled by their crops.

    Raises:
        InputFileError: the target is no picture.
        NoRenderer: there is a drawer, and nothing here can draw.
        ValueError: the scene's own pictures differ in size.
    """
    _require_one_size(pictures)
    registered = register(target, pictures.source, pictures.background)
    picture, notes = registered.picture, list(registered.notes)
    region = table_region(scene.top_camera.camera(), scene.table) & registered.valid
    salience = fit_table(picture, pictures.background, region).salience
    names = [o.phrase for o in scene.objects]
    detections = _surest(_sound(detector.detect(picture, names, pictures.background), picture.shape[:2], notes), notes)
    known = _look(scene, pictures, picture, salience, detections, embedder)
    chosen = assign(known.masks, known.odds)
    found: dict[str, Match] = {}
    why = {o.id: "hidden in the source picture" for o in scene.objects}
    for i, record in enumerate(known.records):
        why[record.id] = "not found in the target picture"
        if i not in chosen:
            continue
        if chosen[i].confidence < DOUBT:
            why[record.id] = f"in doubt in the target picture (confidence {chosen[i].confidence:.2f})"
            continue
        found[record.id] = _match(known, i, chosen[i], threshold, (symmetry or {}).get(record.id, 1), drawer)
    stayed = {i: reason for i, reason in why.items() if i not in found}
    notes += _twice(known, chosen, found)
    rest = kept(scene, plan, pictures.segmentation, found, stayed)
    masks = [known.masks[i][c.index] for i, c in chosen.items() if known.records[i].id in found]
    matches = [found.get(o.id) or rest[o.id] for o in scene.objects]
    return MatchResult(
        settle_twins(scene, plan.relations, matches) if plan else matches,
        _unclaimed(detections, masks, region),
        picture,
        notes,
    )


def _require_one_size(pictures: ScenePictures) -> None:
    sizes = [p.shape[:2] for p in (pictures.source, pictures.segmentation, pictures.background)]
    if len(set(sizes)) > 1:
        raise ValueError(f"the scene's pictures differ in size: {sizes}")


def table_region(camera: Camera, table: Table) -> np.ndarray:
    """(H, W) bool: where the camera sees the table's top, less a little along its edge."""
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.array(table.size) / 2 + table.centre
    pixels = camera.project(np.column_stack([corners, np.full(4, table.height)]))
    drawn = np.zeros((camera.height, camera.width), np.uint8)
    if not np.all(np.isfinite(pixels)):
        return ~drawn.astype(bool)
    cv2.fillConvexPoly(drawn, np.round(np.clip(pixels, -1e4, 1e4)).astype(np.int32), 1)
    return cv2.erode(drawn, np.ones((2 * TABLE_EDGE + 1,) * 2, np.uint8), borderValue=1) > 0


def _sound(detections: Sequence[Detection], shape: tuple[int, int], notes: list[str]) -> list[Detection]:
    """Detections without those whose box, score or mask is none of this picture."""
    sound = [
        d for d in detections if np.all(np.isfinite([*d.box, d.score])) and (d.mask is None or d.mask.shape == shape)
    ]
    if len(sound) < len(detections):
        notes.append(
            f"{len(detections) - len(sound)} detections had no finite box and score, or a mask of another size"
        )
    return sound


def _surest(detections: Sequence[Detection], notes: list[str]) -> list[Detection]:
    if len(detections) <= MOST_DETECTIONS:
        return list(detections)
    notes.append(f"{len(detections)} things were detected; the {MOST_DETECTIONS} surest were looked at")
    return sorted(detections, key=lambda d: -d.score)[:MOST_DETECTIONS]


def _look(
    scene: Scene,
    pictures: ScenePictures,
    picture: np.ndarray,
    salience: np.ndarray,
    detections: Sequence[Detection],
    embedder: Embedder,
) -> _Known:
    """All candidates of all objects that the source shows, with what speaks for them."""
    source = View.of(pictures.source, np.zeros_like(salience))
    masks = {o.id: pictures.segmentation == scene.segmentation_ids.get(o.id, -1) for o in scene.objects}
    records = [o for o in scene.objects if masks[o.id].sum() >= SMALLEST_MASK]
    if not records:
        return _Known(source, source, [], [], [], [], [], [], [])
    crops = [crop_of(source, masks[o.id], scene.top_camera.camera(), o) for o in records]
    centres = np.reshape([((d.box[0] + d.box[2]) / 2, (d.box[1] + d.box[3]) / 2) for d in detections], (-1, 2))
    view, fits = find_candidates(View.of(picture, salience), source, crops, centres)
    drawn = [[mask_at(crop, pose) for pose in fit.poses] for crop, fit in zip(crops, fits, strict=True)]
    similarity = similarities(embedder, pictures.source, recoloured(view), crops, drawn)
    names = [
        name_evidence(crop.record.phrase, middles(crop, fit.poses), detections)
        for crop, fit in zip(crops, fits, strict=True)
    ]
    odds = [log_odds(*three) for three in zip(fits, similarity, names, strict=True)]
    return _Known(view, softened(source), records, crops, fits, drawn, similarity, names, odds)


def _match(known: _Known, i: int, chosen: Chosen, threshold: float, order: int, drawer: Drawer | None) -> Match:
    record, k = known.records[i], chosen.index
    crop, pose = known.crops[i], known.fits[i].poses[k]
    if drawer is not None and drawer.model(record.id) is not None:
        pose = settle_drawn(known.target, record, crop.camera, pose, drawer, order)
        terms, turned = fit(known.target, crop, pose[None]).terms[0], float(pose[2])
    else:
        pose, terms = settle(known.target, known.source, crop, pose)
        turned = smallest_turn(pose[2], order)
    similarity = float(known.similarity[i][k])
    by_name = "name" if known.names[i][k] > 0 else "picture"
    return Match(
        object=record.id,
        method="feature" if similarity > threshold else by_name,
        similarity=similarity,
        confidence=chosen.confidence,
        box=region_of(known.masks[i][k]).box,
        position=(float(pose[0]), float(pose[1])),
        yaw=heading_of(record, turned),
        turned=turned,
        ncc=float(terms[TERMS.index("structure")]),
    )


def _twice(known: _Known, chosen: Mapping[int, Chosen], found: Mapping[str, Match]) -> list[str]:
    names = [known.records[i].phrase for i, c in chosen.items() if c.twin is not None and known.records[i].id in found]
    return [f"the {name} seems to be drawn twice; the better one was taken" for name in names]


def _unclaimed(detections: Sequence[Detection], masks: Sequence[np.ndarray], region: np.ndarray) -> list[Box]:
    """Boxes of what was detected on the table and is not covered by what was matched.

    Of a detection with a mask each part that is left counts by itself: a stranger may touch what was matched.
    """
    free = region.astype(np.uint8)
    for mask in masks:
        free[cv2.dilate(mask.astype(np.uint8), np.ones((9, 9), np.uint8)) > 0] = 0
    boxes: list[Box] = []
    for d in detections:
        if d.mask is None:
            u0, v0, u1, v1 = (max(round(x), 0) for x in d.box)
            inside = free[v0:v1, u0:u1]
            if inside.size and inside.mean() > UNCLAIMED_SHARE:
                boxes.append(tuple(float(x) for x in d.box))
            continue
        rest = cv2.morphologyEx(d.mask.astype(np.uint8) & free, cv2.MORPH_OPEN, np.ones((5, 5), np.uint8))
        _, _, stats, _ = cv2.connectedComponentsWithStats(rest, connectivity=8)
        for u, v, width, height, area in stats[1:].tolist():
            if area >= LEAST_UNCLAIMED:
                boxes.append((float(u), float(v), float(u + width), float(v + height)))
    return boxes
