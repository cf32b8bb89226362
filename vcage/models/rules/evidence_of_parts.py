"""How far two top views show a part to have moved: of drawings of it at many positions the likeliest is told.

Drawings have no shadows, while a drawer that comes out lies in that of its cabinet: a grey drawer in the sun looks like
a grey table in the shade. So pictures and drawings are compared by their edges and hues, which a shadow leaves.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.models.rules.drawings import brightness, drawn_whole
from vcage.models.rules.evidence import changed
from vcage.models.rules.standing import Sought
from vcage.sim.drawer import Drawing, Window
from vcage.vision.colour import distance, to_lab
from vcage.vision.protocols import View

POSITIONS = np.linspace(0.0, 1.0, 17)
"""Positions of a joint that are drawn, as shares of its range."""

DIFFERENT = 10.0
"""Least colour distance between two of the drawings of a pixel that tells positions apart."""


@dataclass(frozen=True)
class LikenessSettings:
    """How a picture is compared with a drawing.

    Args:
        blur_px: standard deviation with which both are blurred: a pose is found to a pixel or two.
        floor: light, of 1 for white, that is added to all, for black has no logarithm.
        edge_cap_per_px: most by which a pixel's gradients of the logarithm of light can differ.
        hue_weight_per_lab: of a difference in hue beside one of such gradients.
        hue_cap_lab: most that a pixel's hues (CIELAB a, b) can differ by.
    """

    blur_px: float = 1.3
    floor: float = 0.004
    edge_cap_per_px: float = 0.3
    hue_weight_per_lab: float = 0.005
    hue_cap_lab: float = 20.0


SETTINGS = LikenessSettings()

DrawPart = Callable[[Pose, Camera, Window, float], Drawing]
"""The object alone at a pose, its part at a share of its range."""


@dataclass(frozen=True)
class PartEvidence:
    """Measurements, all from pixels.

    Args:
        told_by: pixels in which the drawings differ.
        before, after: share of its range at which the part is likeliest.
        costs: (17,) how unlike the picture afterwards the drawing at each of :data:`POSITIONS` is, in edges and hues.
        rival: by how much less unlike the best of them is than the best drawing in which another part of the object
            moved instead; inf where it has no other.
        touched: share of what is seen of the part that has changed in the picture of the moment; 0 without one.
        covered: (H, W) bool, where the object is with its part anywhere.
    """

    told_by: int
    before: float
    after: float
    costs: np.ndarray
    rival: float
    touched: float
    covered: np.ndarray


def gather_part(
    before: View,
    after: View,
    thing: Sought,
    start: float,
    draw: DrawPart,
    rivals: Sequence[DrawPart],
    background: np.ndarray,
    *,
    moment: View | None = None,
) -> PartEvidence | None:
    """Measure one sub-task that moves a part; None where the object is not found before.

    Args:
        before, after: from above.
        thing: the object, its part as it is before, by the plan.
        start: share of its range that the part is at before, by the plan: 0 or 1.
        draw: draws it with its part anywhere.
        rivals: draw it with another part anywhere, and the part as it is before.
        background: (H, W, 3) uint8 RGB, the empty table from above.
        moment: from above while the part was touched, where there is such a view.
    """
    stands = thing.found({"top": before})
    if stands is None:
        return None

    def drawn(share: float, draw: DrawPart = draw) -> Drawing:
        return drawn_whole(lambda pose, camera, window: draw(pose, camera, window, share), stands.pose, before.camera)

    own = [drawn(share) for share in POSITIONS]
    begun = own[-1] if start else own[0]
    gain, touched = brightness(begun, before.picture), 0.0
    sight = _Sight(own, gain, background)
    if moment is not None:
        part = sight.telling if sight.telling.any() else sight.covered
        touched = float(changed(*(to_lab(view.picture) for view in (after, moment)))[part].mean())
    first, then = sight.costs(before.picture), sight.costs(after.picture)
    sights = [sight, *(_Sight([drawn(share, rival) for share in POSITIONS], gain, background) for rival in rivals)]
    where = np.any([one.telling for one in sights], axis=0)
    least = []
    for one, how in zip(sights, (draw, *rivals), strict=True):
        costs = one.costs(after.picture, where)
        # Drawers look so much alike that a step between two positions hides which of them moved.
        between = _Sight([drawn(likeliest(costs), how)], gain, background).costs(after.picture, where)
        least.append(min(costs.min(), between.min()))
    rival = float(min(least[1:], default=np.inf) - least[0])
    moved = likeliest(first), likeliest(then)
    return PartEvidence(int(sight.telling.sum()), *moved, then, rival, touched, sight.covered)


class _Sight:
    """Drawings of an object at one pose with a part at one position after another.

    Args:
        drawings: in their order.
        gain: (3,) by which they are made as bright as the pictures are.
        background: the empty table.

    Attributes:
        covered: (H, W) bool, where the object is in any of them.
        telling: (H, W) bool, where they differ.
    """

    def __init__(self, drawings: Sequence[Drawing], gain: np.ndarray, background: np.ndarray):
        pictures = [_composed(drawing, background, gain) for drawing in drawings]
        self._drawn = [_edges_and_hues(picture) for picture in pictures]
        self.covered = np.any([drawing.covered for drawing in drawings], axis=0)
        first, *rest = [to_lab(picture) for picture in pictures]
        differ = [distance(lab, first) > DIFFERENT for lab in rest]
        self.telling = self.covered & np.any(differ, axis=0) if differ else np.zeros_like(self.covered)

    def costs(self, picture: np.ndarray, where: np.ndarray | None = None) -> np.ndarray:
        """(n,) mean unlikeness of a picture (H, W, 3) uint8 RGB to each drawing, where drawings differ or ``where``
        (H, W) bool says."""
        where = self.telling if where is None else where
        if not where.any():
            return np.zeros(len(self._drawn))
        seen = _edges_and_hues(picture)[where]
        return np.array([_unlike(seen, drawn[where]) for drawn in self._drawn])


def _edges_and_hues(picture: np.ndarray) -> np.ndarray:
    """(H, W, 4) float32: the gradient of the logarithm of light, per pixel, and CIELAB a and b, of an RGB picture."""
    smooth = cv2.GaussianBlur(picture, (0, 0), SETTINGS.blur_px)
    grey = cv2.cvtColor(smooth, cv2.COLOR_RGB2GRAY).astype(np.float32) / 255
    light = np.log(grey**2.2 + SETTINGS.floor)
    along_x, along_y = (cv2.Sobel(light, cv2.CV_32F, *axis, ksize=3, scale=1 / 8) for axis in ((1, 0), (0, 1)))
    return np.dstack([along_x, along_y, to_lab(smooth)[..., 1:]])


def _unlike(seen: np.ndarray, drawn: np.ndarray) -> float:
    """Mean difference of edges and hues of pixels, (n, 4) each."""
    apart = seen - drawn
    edge, hue = np.linalg.norm(apart[:, :2], axis=1), np.linalg.norm(apart[:, 2:], axis=1)
    edge, hue = np.minimum(edge, SETTINGS.edge_cap_per_px), np.minimum(hue, SETTINGS.hue_cap_lab)
    return float((edge + SETTINGS.hue_weight_per_lab * hue).mean())


def likeliest(costs: np.ndarray) -> float:
    """The position of least cost, refined between its neighbours."""
    k = int(np.argmin(costs))
    if k in (0, len(costs) - 1):
        return float(POSITIONS[k])
    left, middle, right = costs[k - 1 : k + 2]
    bend = left - 2 * middle + right
    offset = 0.5 * (left - right) / bend if bend > 1e-6 else 0.0
    return float(POSITIONS[k] + offset * (POSITIONS[1] - POSITIONS[0]))


def _composed(drawing: Drawing, background: np.ndarray, gain: np.ndarray) -> np.ndarray:
    """The drawing, brighter by a factor (3,), on the empty table."""
    bright = np.clip(drawing.picture.astype(np.float32) * gain, 0, 255)
    return np.where(drawing.covered[..., None], bright, background).astype(np.uint8)
