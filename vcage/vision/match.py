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

import numpy as np

from vcage.base.geometry import wrap_angle
from vcage.base.workers import one_blas_thread
from vcage.schema.matches import Match
from vcage.schema.plan import LayoutPlan, Plan
from vcage.schema.scene import Scene
from vcage.sim.drawer import Drawer
from vcage.vision.assignment import Chosen, assign
from vcage.vision.detections import PixelBox, unclaimed_boxes
from vcage.vision.heading_by_render import settle_heading
from vcage.vision.identical_objects import settle_identical
from vcage.vision.object_search import Candidates, find_candidates
from vcage.vision.observation import Observation, ScenePictures, observe
from vcage.vision.pose_score import fit
from vcage.vision.protocols import Detection, Detector, Embedder
from vcage.vision.symmetry import smallest_turn
from vcage.vision.unmatched import stored_matches

THRESHOLD = 0.5
"""The paper's τ, for which it gives no value. In the benchmark's pictures right matches have cosine similarities of
0.87 at least by the classical embedder's features, and of 0.55 by EfficientNet's."""

LEAST_CONFIDENCE = 0.38
"""A match of less confidence is not made."""

HIDDEN, NOT_FOUND = "hidden in the source picture", "not found in the target picture"


@dataclass(frozen=True)
class Recogniser:
    """The models that tell objects apart.

    Args:
        detector: adds places to look at and names, and finds strangers.
        embedder: makes the features.
        threshold: the paper's τ: an object whose features are no more similar than this is matched only where the
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
    reasons = {o.id: rejected.get(o.id, HIDDEN) for o in scene.objects if o.id not in found}
    found |= stored_matches(observation, plan, found, reasons)
    matches = [found[o.id] for o in scene.objects]
    return MatchResult(
        settle_identical(scene, plan.relations, matches) if plan else matches,
        unclaimed_boxes(
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
