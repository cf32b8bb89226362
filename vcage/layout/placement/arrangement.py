"""A partial solution of a :class:`~vcage.layout.placement.plane.Plane`: placed items, and the regions still free."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from vcage.layout.placement.free_region import TOLERANCE, FreeRegion, free_region
from vcage.layout.placement.plane import Plane, Stance

TOUCH_M = 1e-7
"""Gaps that are smaller count as touching."""

RELATED_POINTS = 32
"""Points that are drawn of a free region, to find one at which relations hold that are no rectangles."""


class Spot(NamedTuple):
    """The place of an item on its plane.

    Args:
        stance: the room that it takes.
        centre: (2,) metres.
        yaw: radians.
    """

    stance: Stance
    centre: np.ndarray
    yaw: float


class Arrangement:
    """Some items of a plane at their places.

    Args:
        plane: the problem.
    """

    def __init__(self, plane: Plane):
        self.plane = plane
        self._first = len(plane.obstacles)
        self._boxes = np.concatenate([plane.obstacles, np.zeros((len(plane.items), 2, 2))])  # (m + n, 2, 2)
        self._taken = np.arange(len(self._boxes)) < self._first
        self._spots: dict[int, Spot] = {}

    @property
    def spots(self) -> dict[int, Spot]:
        """Places of the placed items, by index."""
        return dict(self._spots)

    def region(self, k: int, stance: Stance, yaw: float) -> FreeRegion:
        """Region of the centre of item ``k`` at ``yaw`` among all the others, as far as rectangles can express the
        relations to them (:meth:`related`)."""
        taken = self._taken.copy()
        taken[self._first + k] = False
        plane, unions = self.plane, stance.unions
        if plane.related is not None:
            unions = (*unions, *plane.related.cuts(plane.items[k].id, yaw, self._other_spots(k)))
        return free_region(plane.bounds, stance.half, self._boxes[taken], plane.margin, unions)

    def related(self, k: int, yaw: float, centres: np.ndarray) -> np.ndarray:
        """(c, 2) the centres of item ``k`` at ``yaw`` that satisfy all relations to the others."""
        related = self.plane.related
        if related is None or not len(centres):
            return centres
        return centres[related.kept(self.plane.items[k].id, yaw, centres, self._other_spots(k))]

    def draw(self, k: int, stance: Stance, yaw: float, rng: np.random.Generator) -> np.ndarray | None:
        """(2,) a random one of the points where the centre of item ``k`` may be; None where none is found."""
        region = self.region(k, stance, yaw)
        if region.is_empty:
            return None
        if self.plane.related is None or not self.plane.related.binds(self.plane.items[k].id):
            return region.sample(rng)
        return next(iter(self.related(k, yaw, region.samples(rng, RELATED_POINTS))), None)

    def _other_spots(self, k: int) -> dict[str, Spot]:
        return {self.plane.items[j].id: spot for j, spot in self._spots.items() if j != k}

    def conflicts(self, k: int, stance: Stance, centres: np.ndarray) -> np.ndarray:
        """(c, n) bool: which of the other items stand too close for item ``k`` at the ``centres`` (c, 2)."""
        boxes, grow = self._boxes[self._first :], stance.half + self.plane.margin - TOLERANCE
        near = (centres[:, None] > boxes[:, 0] - grow) & (centres[:, None] < boxes[:, 1] + grow)  # (c, n, 2)
        others = self._taken[self._first :].copy()
        others[k] = False
        return near.all(axis=2) & others

    def touching(self, stance: Stance, centres: np.ndarray) -> np.ndarray:
        """(c,) share of its border that an item has at the bounds or at its gap from others, at (c, 2) centres."""
        boxes, gap = self._boxes[self._taken], self.plane.margin
        lower, upper = centres - stance.half, centres + stance.half
        shared = np.minimum(upper[:, None], boxes[:, 1] + gap) - np.maximum(lower[:, None], boxes[:, 0] - gap)
        touches = np.abs(shared) < TOUCH_M  # (c, n, 2) along that axis; the border is shared along the other one
        length = np.where(touches, shared[..., ::-1].clip(min=0), 0.0).sum(axis=(1, 2))
        walls = (lower - self.plane.bounds[0] < TOUCH_M).astype(int) + (
            self.plane.bounds[1] - upper < TOUCH_M
        )  # (c, 2)
        return (length + walls @ (2 * stance.half[::-1])) / (4 * stance.half.sum())

    def put(self, k: int, spot: Spot) -> None:
        """Place item ``k``, or move it."""
        box = self._boxes[self._first + k]
        box[0], box[1] = spot.centre - spot.stance.half, spot.centre + spot.stance.half
        self._taken[self._first + k] = True
        self._spots[k] = spot

    def take(self, k: int) -> None:
        """Take item ``k`` away."""
        self._taken[self._first + k] = False
        del self._spots[k]

    def restore(self, spots: Mapping[int, Spot]) -> None:
        """Make ``spots`` the whole arrangement."""
        self._taken[self._first :] = False
        self._spots.clear()
        for k, spot in spots.items():
            self.put(k, spot)
