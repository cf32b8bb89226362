"""How far two top views show a part to have moved: of drawings of it at many positions the likeliest is told."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.models.rules.evidence import changed
from vcage.models.rules.standing import CAP, Sought, as_bright, drawn_whole
from vcage.sim.drawer import Drawing, Window
from vcage.vision.colour import distance, smoothed, to_lab
from vcage.vision.protocols import View

POSITIONS = np.linspace(0.0, 1.0, 9)
"""Positions of a joint that are drawn, as shares of its range."""

DIFFERENT = 10.0
"""Least colour distance between two of the drawings of a pixel that tells positions apart."""

DrawPart = Callable[[Pose, Camera, Window, float], Drawing]
"""The object alone at a pose, its part at a share of its range."""


@dataclass(frozen=True)
class PartEvidence:
    """Measurements, all from pixels.

    Args:
        told_by: pixels in which the drawings differ.
        before, after: share of its range at which the part is likeliest.
        costs: (9,) how unlike the picture afterwards the drawing at each of :data:`POSITIONS` is.
        touched: share of what is seen of the part that has changed in the picture of the moment; 0 without one.
        covered: (H, W) bool, where the object is with its part anywhere.
    """

    told_by: int
    before: float
    after: float
    costs: np.ndarray
    touched: float
    covered: np.ndarray


def gather_part(
    before: View, after: View, thing: Sought, draw: DrawPart, background: np.ndarray, *, moment: View | None = None
) -> PartEvidence | None:
    """Measure one sub-task that moves a part; None where the object is not found before.

    Args:
        before, after: from above.
        thing: the object, its part as it is before, by the plan.
        draw: draws it with its part anywhere.
        background: (H, W, 3) uint8 RGB, the empty table from above.
        moment: from above while the part was touched, where there is such a view.
    """
    stands = thing.found({"top": before})
    if stands is None:
        return None

    def drawn(share: float) -> Drawing:
        return drawn_whole(lambda pose, camera, window: draw(pose, camera, window, share), stands.pose, before.camera)

    sight, touched = _Sight([drawn(share) for share in POSITIONS], before.picture, background), 0.0
    if moment is not None:
        part = sight.telling if sight.telling.any() else sight.covered
        touched = float(changed(*(to_lab(view.picture) for view in (after, moment)))[part].mean())
    first, then = sight.costs(before.picture), sight.costs(after.picture)
    return PartEvidence(int(sight.telling.sum()), likeliest(first), likeliest(then), then, touched, sight.covered)


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

    def costs(self, picture: np.ndarray) -> np.ndarray:
        """(9,) mean colour distance of a picture (H, W, 3) uint8 RGB from each drawing where drawings differ."""
        if not self.telling.any():
            return np.zeros(len(POSITIONS))
        lab = smoothed(picture)
        return np.array([np.minimum(distance(lab, drawn)[self.telling], CAP).mean() for drawn in self._labs])


def likeliest(costs: np.ndarray) -> float:
    """The position of least cost, refined between its neighbours."""
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
