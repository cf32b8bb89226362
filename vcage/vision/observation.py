"""A scene's own picture and an edited picture of the same objects, prepared once for all steps of matching.

Both pictures are in the frame of the scene's top camera and in the colours of the source.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Camera
from vcage.schema.scene import ObjectRecord, Scene
from vcage.vision.colour import LabImage, transfer_statistics
from vcage.vision.protocols import Detection, Detector
from vcage.vision.register import register
from vcage.vision.table_model import fit_table, table_region

LEAST_MASK_PX = 12
"""Area of the smallest mask from which features are taken; an object of which less is visible counts as hidden."""


@dataclass(frozen=True)
class ScenePictures:
    """Pictures that were taken of a scene.

    Args:
        source: (H, W, 3) uint8 top view.
        segmentation: (H, W) int, values of ``scene.segmentation_ids``.
        background: (H, W, 3) uint8, the same view of the empty table.

    Raises:
        ValueError: the pictures differ in size.
    """

    source: np.ndarray
    segmentation: np.ndarray
    background: np.ndarray

    def __post_init__(self) -> None:
        sizes = [p.shape[:2] for p in (self.source, self.segmentation, self.background)]
        if len(set(sizes)) > 1:
            raise ValueError(f"the scene's pictures differ in size: {sizes}")


@dataclass(frozen=True)
class Observation:
    """All that matching compares.

    Args:
        scene: the known objects.
        source: (H, W, 3) uint8, the scene's own picture.
        source_lab: the same as it is compared.
        shown: ids of the objects with at least one pixel visible in the source.
        masks: (H, W) bool by id, the place of each object with enough pixels in the source to search for it.
        picture: (H, W, 3) uint8, the edited picture in the frame of the source.
        target: the edited picture as it is compared: in the colours of the source, with its salience.
        region: (H, W) bool, the part of the table that the edited picture shows.
        detections: of the edited picture, the surest first where some were left out.
        notes: peculiarities of the edited picture, in sentences.
    """

    scene: Scene
    source: np.ndarray
    source_lab: LabImage
    shown: frozenset[str]
    masks: Mapping[str, np.ndarray]
    picture: np.ndarray
    target: LabImage
    region: np.ndarray
    detections: list[Detection]
    notes: list[str]

    @property
    def camera(self) -> Camera:
        """The camera of both pictures."""
        return self.scene.top_camera.camera()

    @property
    def visible(self) -> list[ObjectRecord]:
        """The objects that have a mask, in the scene's order."""
        return [o for o in self.scene.objects if o.id in self.masks]

    @property
    def detected_at(self) -> np.ndarray:
        """(n, 2) pixels of the middles of the detections."""
        return np.reshape([d.centre for d in self.detections], (-1, 2))


def observe(scene: Scene, pictures: ScenePictures, edited: np.ndarray, detector: Detector) -> Observation:
    """Bring an edited picture into the frame and the colours of a scene's own picture.

    Args:
        scene: the known objects.
        pictures: of the scene.
        edited: (h, w, 3) uint8 answer of an image model, of any size and crop.
        detector: looks for the objects by their phrases.
    """
    registered = register(edited, pictures.source, pictures.background)
    picture = registered.picture
    region = table_region(scene.top_camera.camera(), scene.table) & registered.valid
    salience = fit_table(picture, pictures.background, region).salience
    detected = detector.detect(picture, [o.phrase for o in scene.objects], pictures.background)
    detections, doubts = _usable(detected, picture.shape[:2])
    areas = {o.id: pictures.segmentation == scene.segmentation_ids.get(o.id, -1) for o in scene.objects}
    masks = {name: mask for name, mask in areas.items() if mask.sum() >= LEAST_MASK_PX}
    source_lab = LabImage.of(pictures.source, np.zeros_like(salience))
    covered = np.isin(pictures.segmentation, [scene.segmentation_ids[name] for name in masks])
    return Observation(
        scene=scene,
        source=pictures.source,
        source_lab=source_lab,
        shown=frozenset(name for name, mask in areas.items() if mask.any()),
        masks=masks,
        picture=picture,
        target=transfer_statistics(LabImage.of(picture, salience), source_lab, covered),
        region=region,
        detections=detections,
        notes=[*registered.notes, *doubts],
    )


def _usable(
    detections: Sequence[Detection], shape: tuple[int, ...], most: int = 200
) -> tuple[list[Detection], list[str]]:
    """The ``most`` surest detections whose box, score and mask fit a picture (H, W); and notes on those left out."""
    notes = []
    sound = [
        d for d in detections if np.all(np.isfinite([*d.box, d.score])) and (d.mask is None or d.mask.shape == shape)
    ]
    if len(sound) < len(detections):
        count = len(detections) - len(sound)
        notes.append(f"{count} detections had no finite box and score, or a mask of another size")
    if len(sound) > most:
        notes.append(f"{len(sound)} things were detected in the target picture; the surest {most} are used")
        sound = sorted(sound, key=lambda d: -d.score)[:most]
    return sound, notes
