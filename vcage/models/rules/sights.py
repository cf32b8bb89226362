"""What views show around a place, and how unlike a drawing of an object there they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.models.rules.drawings import Draw, as_bright, cut, window_around
from vcage.sim.drawer import Window
from vcage.vision.colour import distance, smoothed, to_lab
from vcage.vision.protocols import View

CAP = 30.0
"""Largest colour distance that a pixel can cost."""

UNFILLED = 20.0
"""Colour distance that a pixel of an outline costs which a drawing leaves open."""

UNSEEN = 6.0
"""Colour distance that a pixel costs which something hides."""


@dataclass(frozen=True)
class Sight:
    """A view around a place.

    Args:
        camera, window: that see it.
        picture: (side, side, 3) uint8.
        lab: the same, smoothed.
        outline: (side, side) bool, what a drawing should fill.
        hidden: (side, side) bool, where something hides what is behind it.
    """

    camera: Camera
    window: Window
    picture: np.ndarray
    lab: np.ndarray
    outline: np.ndarray
    hidden: np.ndarray

    @classmethod
    def of(
        cls,
        view: View,
        middle: np.ndarray,
        size: Sequence[float],
        outline: np.ndarray | None,
        hidden: np.ndarray | None = None,
    ) -> Sight:
        window = window_around(middle, size, view.camera)
        picture = cut(view.picture, window)
        lab = smoothed(picture)
        none = np.zeros(picture.shape[:2], bool)
        masks = [none if mask is None else cut(mask, window) for mask in (outline, hidden)]
        return cls(view.camera, window, picture, lab, *masks)


def unlikeness(pose: np.ndarray, height: float, sights: Sequence[Sight], draw: Draw) -> float:
    """Mean colour distance between sights and drawings of the object at (3,) x, y and heading."""
    costs = []
    for sight in sights:
        drawing = draw(Pose.from_yaw([pose[0], pose[1], height], float(pose[2])), sight.camera, sight.window)
        if not drawing.covered.any():
            return CAP
        drawn = to_lab(as_bright(drawing, sight.picture, sight.hidden).astype(np.uint8))
        apart = np.where(sight.hidden, UNSEEN, np.minimum(distance(sight.lab, drawn), CAP))[drawing.covered].mean()
        costs.append(apart + UNFILLED * (sight.outline & ~drawing.covered).sum() / drawing.covered.sum())
    return float(np.mean(costs))
