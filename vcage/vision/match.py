"""Matching: where each known object stands in an edited picture of the scene (paper, section III-A3).

The steps are those of the paper: detections of the edited picture, features of regions, pairs, coordinates by the
inverse projection, rotation by correlation. Their order differs. Detections of an edited picture merge objects that
touch, miss pale ones and follow shadows, while every known object has a template of its own. So each template is laid
over the picture at every place and heading first. Detections add places to look at and names. Features, correlation,
colours and outline decide together. The heading is settled last, by drawings of the object's model at its place.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np

from vcage.base.geometry import Pose, wrap_angle
from vcage.base.workers import one_blas_thread
from vcage.layout.intended import intended_layout
from vcage.layout.items import item_of
from vcage.schema.matches import Match
from vcage.schema.plan import LayoutPlan, Plan
from vcage.schema.scene import ObjectRecord, Scene
from vcage.sim.drawer import Drawer
from vcage.vision.assignment import Chosen, assign
from vcage.vision.heading_by_render import settle_heading
from vcage.vision.identical_objects import settle_identical
from vcage.vision.object_search import Candidates, find_candidates
from vcage.vision.observation import Observation, ScenePictures, observe
from vcage.vision.pose_score import fit
from vcage.vision.protocols import Detection, Detector, Embedder
from vcage.vision.symmetry import smallest_turn

THRESHOLD = 0.5
"""The paper's τ, for which it gives no value. In the benchmark's pictures right matches have cosine similarities of
0.87 at least by the classical embedder's features, and of 0.55 by EfficientNet's."""

LEAST_CONFIDENCE = 0.38
"""A match of less confidence is not made."""

ALONG = "goes along with what it lies in"
HIDDEN, NOT_FOUND = "hidden in the source picture", "not found in the target picture"


PixelBox = tuple[float, float, float, float]
"""u0, v0, u1, v1, half open."""


@dataclass(frozen=True)
class Recogniser:
    """The models that tell objects apart.

    Args:
        detector: adds places to look at and names, and finds strangers.
        embedder: makes the features.
        threshold: the paper's τ: an object with features no more similar than this is matched only where the
            detector's label supports it.
    """

    detector: Detector
    embedder: Embedder
    threshold: float = THRESHOLD


@dataclass(frozen=True)
class Looks:
    """Knowledge about the looks of the scene's objects.

    Args:
        symmetry: object id → n-fold rotational symmetry seen from above (0: round); 1 where it is not given.
        drawer: draws objects of the scene; an object without a model keeps the heading at which it was found.
    """

    symmetry: Mapping[str, int] = field(default_factory=dict)
    drawer: Drawer | None = None


@dataclass(frozen=True)
class MatchResult:
    """The objects of the scene in the edited picture.

    Args:
        matches: one per object, in the scene's order.
        unclaimed: boxes of detections that no object claimed, pixels.
        picture: (H, W, 3) uint8, the edited picture in the source's frame.
        notes: peculiarities of the picture, in sentences.
    """

    matches: list[Match]
    unclaimed: list[PixelBox]
    picture: np.ndarray
    notes: list[str]


@one_blas_thread()
def match_picture(
    scene: Scene,
    plan: LayoutPlan | Plan | None,
    pictures: ScenePictures,
    target: np.ndarray,
    recogniser: Recogniser,
    looks: Looks,
) -> MatchResult:
    """Find every object of the scene in the edited picture.

    Args:
        scene: the known objects.
        plan: places objects that the picture does not show; None keeps them where they were.
        pictures: of the scene.
        target: (h, w, 3) uint8 answer of an image model, of any size and crop.
        recogniser: detector, embedder and the threshold of their features.
        looks: symmetries and drawings of the objects.

    Raises:
        NoRenderer: there is a drawer, and nothing here can draw.
    """
    observation = observe(scene, pictures, target, recogniser.detector)
    observation, candidates = find_candidates(observation, recogniser.embedder)
    chosen = assign([one.masks for one in candidates], [one.odds for one in candidates])
    rejected = {one.record.id: _rejection(one, chosen.get(i), recogniser) for i, one in enumerate(candidates)}
    accepted = [(one, chosen[i]) for i, one in enumerate(candidates) if not rejected[one.record.id]]
    found = {one.record.id: _match(observation, one, choice, recogniser, looks) for one, choice in accepted}
    reasons = {o.id: rejected.get(o.id, ALONG if o.heaped else HIDDEN) for o in scene.objects if o.id not in found}
    found |= stored_matches(observation, plan, found, reasons)
    matches = [found[o.id] for o in scene.objects]
    return MatchResult(
        settle_identical(scene, plan.relations, matches) if plan else matches,
        _unclaimed_boxes(
            observation.detections, [one.masks[choice.index] for one, choice in accepted], observation.region
        ),
        observation.picture,
        [*observation.notes, *_drawn_twice(accepted)],
    )


def _rejection(one: Candidates, choice: Chosen | None, recogniser: Recogniser) -> str:
    """The reason why an object is not matched as it was chosen; empty when it is."""
    if choice is None:
        return NOT_FOUND
    if choice.confidence < LEAST_CONFIDENCE:
        return f"in doubt in the target picture (confidence {choice.confidence:.2f})"
    similarity = float(one.similarity[choice.index])
    if similarity <= recogniser.threshold and one.labels[choice.index] <= 0:
        return f"too unlike what is seen in the target picture (similarity {similarity:.2f})"
    return ""


def _match(observation: Observation, one: Candidates, choice: Chosen, recogniser: Recogniser, looks: Looks) -> Match:
    """The match of an object at its chosen pose, its heading settled by drawings where its model can be drawn."""
    record, pose = one.record, one.fit.poses[choice.index]
    structure = one.fit.term("structure")[choice.index]
    order = looks.symmetry.get(record.id, 1)
    if looks.drawer is not None and looks.drawer.model(record.id) is not None:
        pose = settle_heading(observation.target, observation.camera, record, pose, looks.drawer, order)
        structure, turned = fit(observation.target, one.template, pose[None]).term("structure")[0], float(pose[2])
    else:
        turned = smallest_turn(pose[2], order)
    similarity = float(one.similarity[choice.index])
    return Match(
        object=record.id,
        method="feature" if similarity > recogniser.threshold else "name",
        similarity=similarity,
        confidence=choice.confidence,
        box=Detection.of_mask(one.masks[choice.index]).box,
        position=(float(pose[0]), float(pose[1])),
        yaw=float(wrap_angle(record.pose.pose().yaw + turned)),
        turned=turned,
        ncc=float(structure),
    )


def _drawn_twice(accepted: Sequence[tuple[Candidates, Chosen]]) -> list[str]:
    return [
        f"the {one.record.phrase} seems to be drawn twice; the better one was taken"
        for one, choice in accepted
        if choice.twin is not None
    ]


def _unclaimed_boxes(
    detections: Sequence[Detection], masks: Sequence[np.ndarray], region: np.ndarray, beside_px: int = 4
) -> list[PixelBox]:
    """Boxes of detections on the table that matched objects do not cover.

    Each remaining part of a detected mask counts by itself: a stranger may touch a matched object.

    Args:
        detections: of the picture.
        masks: (H, W) bool, outlines of the matched objects.
        region: (H, W) bool, the table.
        beside_px: margin around a matched object that is left out.
    """
    side = 2 * beside_px + 1
    free = region.astype(np.uint8)
    for mask in masks:
        free[cv2.dilate(mask.astype(np.uint8), np.ones((side, side), np.uint8)) > 0] = 0
    return [box for detection in detections for box in _free_parts(detection, free)]


def _free_parts(
    detection: Detection, free: np.ndarray, least_share: float = 0.5, least_px: int = 80, speck_px: int = 5
) -> list[PixelBox]:
    """Boxes of the parts of a detection that lie where ``free`` (H, W) uint8 is 1.

    Args:
        least_share: of a detected box that must be free.
        least_px: area of the free part of a detected mask.
        speck_px: parts of a detected mask that are narrower do not count.
    """
    if detection.mask is None:
        u0, v0, u1, v1 = (max(round(x), 0) for x in detection.box)
        inside = free[v0:v1, u0:u1]
        return [detection.box] if inside.size and inside.mean() > least_share else []
    kernel = np.ones((speck_px, speck_px), np.uint8)
    rest = cv2.morphologyEx(detection.mask.astype(np.uint8) & free, cv2.MORPH_OPEN, kernel)
    _, _, stats, _ = cv2.connectedComponentsWithStats(rest, connectivity=8)
    boxes = np.column_stack([stats[:, :2], stats[:, :2] + stats[:, 2:4]]).astype(float)
    large = [i for i in range(1, len(stats)) if stats[i, cv2.CC_STAT_AREA] >= least_px]
    return [(u0, v0, u1, v1) for u0, v0, u1, v1 in boxes[large].tolist()]


def stored_matches(
    observation: Observation, plan: LayoutPlan | Plan | None, found: Mapping[str, Match], reasons: Mapping[str, str]
) -> dict[str, Match]:
    """A match of the method "kept" for each object that was not found.

    An object goes where the plan wants it beside the found ones, if the source shows it and the plan has it as a
    subject; any other object stays where it was. The note says which.

    Args:
        observation: scene, and which objects the source shows.
        plan: relations for the layout.
        found: matches by object id.
        reasons: object id → why it was not found.

    Raises:
        UnknownName: the scene's robot does not exist; the plan needs it to leave room for hands.
    """
    planned = _planned_poses(observation, plan, found, reasons)
    return {
        name: _stored(observation.scene.object(name), reason, planned.get(name)) for name, reason in reasons.items()
    }


def _planned_poses(
    observation: Observation, plan: LayoutPlan | Plan | None, found: Mapping[str, Match], reasons: Mapping[str, str]
) -> Mapping[str, Pose]:
    scene = observation.scene
    subjects = {r.subject for r in plan.relations} & set(reasons) & observation.shown if plan else set()
    if not plan or not subjects:
        return {}
    fixed = {o.id: o.pose.pose() for o in scene.objects if o.id not in subjects}
    for name, match in found.items():
        fixed[name] = Pose.from_yaw([*match.position, scene.object(name).pose.position[2]], match.yaw)
    layout = intended_layout(scene, plan.relations, {o.id: item_of(o) for o in scene.objects}, fixed)
    return {name: layout.poses[name] for name in subjects}


def _stored(record: ObjectRecord, reason: str, planned: Pose | None) -> Match:
    before = record.pose.pose()
    pose = planned or before
    turned = float(wrap_angle(pose.yaw - before.yaw))
    return Match(
        object=record.id,
        method="kept",
        similarity=None,
        confidence=0.0,
        box=None,
        position=(float(pose.p[0]), float(pose.p[1])),
        yaw=float(wrap_angle(before.yaw + turned)),
        turned=turned,
        ncc=None,
        note=f"{reason}; " + ("put where the plan wants it" if planned else "kept where it was"),
    )
