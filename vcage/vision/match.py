"""Correspondence between the source and the target picture (paper, section III-A3).

As in the paper: detections of the target picture, features of regions, pairs, coordinates by the inverse projection,
rotation by normalised cross-correlation. What differs is the order. Detections of an edited picture merge what touches,
miss what is pale and follow shadows, while every known object has a template of its own; so each template is laid over
the target at every place and heading first, the detections only say where to look as well and what things are called,
and features, correlation, colours and outline together decide. Which way an object faces is settled last, where it is,
by drawings of its model.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from vcage.base.geometry import wrap_angle
from vcage.base.workers import one_blas_thread
from vcage.schema.matches import Match
from vcage.schema.plan import LayoutPlan, Plan
from vcage.schema.scene import ObjectRecord, Scene
from vcage.sim.drawer import Drawer
from vcage.vision.assignment import Chosen, assign
from vcage.vision.candidates import find_candidates
from vcage.vision.colour import LabImage
from vcage.vision.detections import PixelBox, region_of, sound_detections, unclaimed_boxes
from vcage.vision.evidence import SMALLEST_MASK, label_evidence, log_odds, similarities
from vcage.vision.heading_by_render import settle_heading
from vcage.vision.identical_objects import settle_identical
from vcage.vision.object_templates import ObjectTemplate, template_of
from vcage.vision.pose_score import TERMS, Fit, fit, mask_at, middles
from vcage.vision.protocols import Detection, Detector, Embedder
from vcage.vision.register import register
from vcage.vision.symmetry import smallest_turn
from vcage.vision.table_model import fit_table, table_region
from vcage.vision.unmatched import kept

THRESHOLD = 0.5
"""The paper's τ, for which it gives no value. In the benchmark's pictures right matches have cosine similarities of
0.87 at least by the classical embedder's features, and of 0.55 by EfficientNet's."""

DOUBT = 0.38
"""Confidence below which a match is not made."""

HIDDEN, NOT_FOUND = "hidden in the source picture", "not found in the target picture"


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
class Recogniser:
    """What tells objects apart.

    Args:
        detector: says where to look as well, what things are called, and what is there that nobody knows.
        embedder: makes the features.
        threshold: the paper's τ: an object whose features are no more alike than this is matched only where the
            detector's label speaks for it.
    """

    detector: Detector
    embedder: Embedder
    threshold: float = THRESHOLD


@dataclass(frozen=True)
class Looks:
    """What is known of how the scene's objects look.

    Args:
        symmetry: object id → n-fold rotational symmetry seen from above (0: round); 1 where it is not given.
        drawer: draws objects of the scene; those that it has no model of keep the heading at which they were found.
    """

    symmetry: Mapping[str, int] = field(default_factory=dict)
    drawer: Drawer | None = None


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
    unclaimed: list[PixelBox]
    picture: np.ndarray
    notes: list[str]


@dataclass(frozen=True)
class _Candidates:
    """Where one object that the source picture shows may be in the target, the best fit first.

    Args:
        record: the object.
        template: what it was looked for by.
        fit: k poses.
        masks: (H, W) bool, its outline at each pose.
        similarity: (k,) cosines of the features.
        labels: (k,) what the detector's labels say, in [-1, 1].
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


@one_blas_thread()
def match_picture(
    scene: Scene,
    plan: LayoutPlan | Plan | None,
    pictures: ScenePictures,
    target: np.ndarray,
    recogniser: Recogniser,
    looks: Looks,
) -> MatchResult:
    """Where every object of the scene is in the target picture.

    Args:
        scene: the known objects; their order is kept.
        plan: says where objects go that the picture does not show; None keeps them where they were.
        pictures: of the scene.
        target: what an image model answered: any size, grey, RGBA, cropped (:func:`vcage.vision.register.register`).
        recogniser: detector, embedder and the threshold of their features.
        looks: symmetries and drawings of the objects.

    Raises:
        InputFileError: the target is no picture.
        NoRenderer: there is a drawer, and nothing here can draw.
        ValueError: the scene's own pictures differ in size.
    """
    sizes = [p.shape[:2] for p in (pictures.source, pictures.segmentation, pictures.background)]
    if len(set(sizes)) > 1:
        raise ValueError(f"the scene's pictures differ in size: {sizes}")
    registered = register(target, pictures.source, pictures.background)
    picture = registered.picture
    region = table_region(scene.top_camera.camera(), scene.table) & registered.valid
    image = LabImage.of(picture, fit_table(picture, pictures.background, region).salience)
    phrases = [o.phrase for o in scene.objects]
    detected = recogniser.detector.detect(picture, phrases, pictures.background)
    detections, doubts = sound_detections(detected, picture.shape[:2])
    image, candidates = _look(scene, pictures, image, detections, recogniser.embedder)
    made, refused = _decide(candidates, recogniser.threshold)
    found = {one.record.id: _match(image, one, choice, recogniser.threshold, looks) for one, choice in made}
    missing = {o.id: refused.get(o.id, HIDDEN) for o in scene.objects if o.id not in found}
    rest = kept(scene, plan, pictures.segmentation, found, missing)
    matches = [found.get(o.id) or rest[o.id] for o in scene.objects]
    return MatchResult(
        settle_identical(scene, plan.relations, matches) if plan else matches,
        unclaimed_boxes(detections, [one.masks[choice.index] for one, choice in made], region),
        picture,
        [*registered.notes, *doubts, *_drawn_twice(made)],
    )


def _look(
    scene: Scene, pictures: ScenePictures, image: LabImage, detections: Sequence[Detection], embedder: Embedder
) -> tuple[LabImage, list[_Candidates]]:
    """The target in the source's colours, and the candidates of all objects that the source shows."""
    source = LabImage.of(pictures.source, np.zeros_like(image.salience))
    masks = {o.id: pictures.segmentation == scene.segmentation_ids.get(o.id, -1) for o in scene.objects}
    records = [o for o in scene.objects if masks[o.id].sum() >= SMALLEST_MASK]
    if not records:
        return image, []
    camera = scene.top_camera.camera()
    templates = [
        template_of(source, masks[o.id], camera, np.array(o.aabb), np.array(o.pose.position[:2])) for o in records
    ]
    centres = np.reshape([((d.box[0] + d.box[2]) / 2, (d.box[1] + d.box[3]) / 2) for d in detections], (-1, 2))
    image, fits = find_candidates(image, source, templates, centres)
    drawn = [[mask_at(template, pose) for pose in fit.poses] for template, fit in zip(templates, fits, strict=True)]
    likeness = similarities(embedder, pictures.source, image.rgb(), [t.mask for t in templates], drawn)
    labels = [
        label_evidence(record.phrase, middles(template, fit.poses), detections)
        for record, template, fit in zip(records, templates, fits, strict=True)
    ]
    return image, [_Candidates(*one) for one in zip(records, templates, fits, drawn, likeness, labels, strict=True)]


def _decide(
    candidates: Sequence[_Candidates], threshold: float
) -> tuple[list[tuple[_Candidates, Chosen]], dict[str, str]]:
    """The objects that are matched, each with its choice; and object id → why another is not."""
    chosen = assign([one.masks for one in candidates], [one.odds for one in candidates])
    choices = [(one, chosen.get(i)) for i, one in enumerate(candidates)]
    refused = {one.record.id: _refusal(one, choice, threshold) for one, choice in choices}
    made = [(one, choice) for one, choice in choices if choice and not refused[one.record.id]]
    return made, {name: why for name, why in refused.items() if why}


def _refusal(one: _Candidates, choice: Chosen | None, threshold: float) -> str:
    """Why an object is not matched as it was chosen; empty when it is."""
    if choice is None:
        return NOT_FOUND
    if choice.confidence < DOUBT:
        return f"in doubt in the target picture (confidence {choice.confidence:.2f})"
    similarity = float(one.similarity[choice.index])
    if similarity <= threshold and one.labels[choice.index] <= 0:
        return f"too unlike what is seen in the target picture (similarity {similarity:.2f})"
    return ""


def _match(image: LabImage, one: _Candidates, choice: Chosen, threshold: float, looks: Looks) -> Match:
    record, k = one.record, choice.index
    pose, terms = one.fit.poses[k], one.fit.terms[k]
    order = looks.symmetry.get(record.id, 1)
    if looks.drawer is not None and looks.drawer.model(record.id) is not None:
        pose = settle_heading(image, record, one.template.camera, pose, looks.drawer, order)
        terms, turned = fit(image, one.template, pose[None]).terms[0], float(pose[2])
    else:
        turned = smallest_turn(pose[2], order)
    similarity = float(one.similarity[k])
    return Match(
        object=record.id,
        method="feature" if similarity > threshold else "name",
        similarity=similarity,
        confidence=choice.confidence,
        box=region_of(one.masks[k]).box,
        position=(float(pose[0]), float(pose[1])),
        yaw=float(wrap_angle(record.pose.pose().yaw + turned)),
        turned=turned,
        ncc=float(terms[TERMS.index("structure")]),
    )


def _drawn_twice(made: Sequence[tuple[_Candidates, Chosen]]) -> list[str]:
    return [
        f"the {one.record.phrase} seems to be drawn twice; the better one was taken"
        for one, choice in made
        if choice.twin is not None
    ]
