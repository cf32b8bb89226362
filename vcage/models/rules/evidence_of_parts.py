"""How far two top views show a part to have moved: of drawings of it at many positions the likeliest is told."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.models.rules.evidence import changed, middles, places, salience
from vcage.models.rules.standing import CAP, FLIPS, as_bright, refined
from vcage.sim.drawer import Drawing, Window
from vcage.vision.colour import LabImage, distance, to_lab
from vcage.vision.detector import MIN_AREA, components
from vcage.vision.object_templates import ObjectTemplate, template_from_reference
from vcage.vision.protocols import Reference

POSITIONS = np.linspace(0.0, 1.0, 9)
"""Positions of a joint that are drawn, as shares of its range."""

DIFFERENT = 10.0
"""Least colour distance between two of the drawings of a pixel that tells positions apart."""

STEPS, ROUNDS = np.array([0.006, 0.006, np.radians(4.0)]), 10
"""First steps along x, y and in heading with which a pose is refined by drawing the object, and how often."""

Draw = Callable[[Pose, Camera, Window, float], Drawing]
"""The object alone at a pose, its part at a share of its range."""


@dataclass(frozen=True)
class PartEvidence:
    """Measurements, all from pixels.

    Args:
        told_by: pixels in which the drawings differ.
        before, after: share of its range at which the part is likeliest.
        touched: share of the object that has changed in the picture of the moment; 0 without one.
    """

    told_by: int
    before: float
    after: float
    touched: float


def gather_part(
    before: np.ndarray,
    after: np.ndarray,
    camera: Camera,
    table_height: float,
    was: Reference,
    draw: Draw,
    background: np.ndarray,
    *,
    start: float = 0.0,
    moment: np.ndarray | None = None,
) -> PartEvidence:
    """Measure one sub-task that moves a part.

    Args:
        before, after, background: (H, W, 3) uint8 RGB of the same camera, the last of the empty table.
        camera: took them.
        table_height: metres.
        was: how the object looks from above before.
        draw: draws it as the camera sees it.
        start: share of its range at which the part is before, by the plan.
        moment: the view while the part was touched, where there is one.
    """
    height, width = before.shape[:2]
    window = Window(0, 0, max(camera.width, camera.height), 1)

    def drawn(pose: np.ndarray, share: float) -> Drawing:
        standing = Pose.from_yaw([pose[0], pose[1], table_height], float(pose[2]))
        shown = draw(standing, camera, window, share)
        return Drawing(*(layer[:height, :width] for layer in (shown.picture, shown.covered, shown.depth)))

    rough = _found(before, template_from_reference(was, camera, table_height), background)
    sights = []
    for pose, unlike in _settled(rough, before, background, lambda pose: drawn(pose, start)):
        sight = _Sight([drawn(pose, share) for share in POSITIONS], before, background)
        sights.append((unlike + sight.least_cost(after), sight))
    sight = min(sights, key=lambda found: found[0])[1]
    touched = 0.0
    if moment is not None:
        touched = float(changed(*(to_lab(p) for p in (after, moment)))[sight.covered].mean())
    return PartEvidence(int(sight.telling.sum()), sight.likeliest(before), sight.likeliest(after), touched)


def _found(picture: np.ndarray, template: ObjectTemplate, background: np.ndarray) -> np.ndarray:
    """(3,) x, y and heading at which the object seems to stand."""
    image = LabImage.of(picture, salience(picture, background))
    standing = components(image.salience > 0.5, MIN_AREA * picture.shape[0] * picture.shape[1])
    return places(image, template, middles(standing)).first.poses[0, :3]


def _settled(
    rough: np.ndarray, picture: np.ndarray, background: np.ndarray, draw: Callable[[np.ndarray], Drawing]
) -> list[tuple[np.ndarray, float]]:
    """The two poses (3,) near a rough one, turned by quarters or not, at which drawings of the object are most like the
    picture, and how unlike they still are."""
    lab = _smoothed(picture)

    def unlikeness(pose: np.ndarray) -> float:
        drawing = draw(pose)
        if not drawing.covered.any():
            return np.inf
        return float(np.minimum(distance(lab, to_lab(_composed(drawing, background, picture))), CAP).mean())

    turned = sorted((unlikeness(p), tuple(p)) for p in rough + np.outer(FLIPS, [0, 0, 1]))[:2]
    found = [refined(np.array(start), least, unlikeness, STEPS, ROUNDS) for least, start in turned]
    return [(pose, least) for least, pose in found]


def _smoothed(picture: np.ndarray) -> np.ndarray:
    return to_lab(cv2.GaussianBlur(picture, (3, 3), 0))


class _Sight:
    """Drawings of an object at one pose with its part at every one of :data:`POSITIONS`.

    Args:
        drawings: in their order.
        picture: as bright as this they are made.
        background: the empty table.

    Attributes:
        covered: (H, W) bool, where the object is in any of them.
        telling: (H, W) bool, where they differ.
    """

    def __init__(self, drawings: Sequence[Drawing], picture: np.ndarray, background: np.ndarray):
        self._labs = [to_lab(_composed(drawing, background, picture)) for drawing in drawings]
        self.covered = np.any([drawing.covered for drawing in drawings], axis=0)
        differ = [distance(lab, self._labs[0]) > DIFFERENT for lab in self._labs[1:]]
        self.telling = self.covered & np.any(differ, axis=0)

    def least_cost(self, picture: np.ndarray) -> float:
        """How unlike a picture the likeliest of the drawings is, over all its pixels."""
        lab = _smoothed(picture)
        return min(float(distance(lab, drawn).mean()) for drawn in self._labs)

    def likeliest(self, picture: np.ndarray) -> float:
        """The position whose drawing is most like the picture where drawings differ, refined between its neighbours."""
        if not self.telling.any():
            return 0.0
        lab = _smoothed(picture)
        costs = [np.minimum(distance(lab, drawn)[self.telling], CAP).mean() for drawn in self._labs]
        k = int(np.argmin(costs))
        if k in (0, len(costs) - 1):
            return float(POSITIONS[k])
        left, middle, right = costs[k - 1 : k + 2]
        bend = left - 2 * middle + right
        offset = 0.5 * (left - right) / bend if bend > 1e-6 else 0.0
        return float(POSITIONS[k] + offset * (POSITIONS[1] - POSITIONS[0]))


def _composed(drawing: Drawing, background: np.ndarray, picture: np.ndarray) -> np.ndarray:
    """The drawing on the empty table, as bright as the picture is there."""
    return np.where(drawing.covered[..., None], as_bright(drawing, picture), background).astype(np.uint8)
