"""Compare views around a place with drawings of an object there."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.models.rules.drawings import Draw, as_bright, cut, window_around
from vcage.sim.drawer import Window
from vcage.vision.colour import distance, smoothed, to_lab
from vcage.vision.protocols import View


@dataclass(frozen=True)
class SightSettings:
    """Colour distances (CIELAB) that pixels cost, and how a pose of least cost is found.

    Args:
        cap_lab: most that a pixel can cost.
        unfilled_lab: of a pixel of an outline that a drawing leaves open.
        hidden_lab: of a pixel that something hides.
        steps: first steps along x, y (metres) and in heading (radians) with which a pose is refined.
    """

    cap_lab: float = 30.0
    unfilled_lab: float = 20.0
    hidden_lab: float = 6.0
    steps: tuple[float, float, float] = (0.004, 0.004, math.radians(5.0))


SETTINGS = SightSettings()


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
        """Cut what an object of a size (3,) may cover out of a view, its middle (3,) in the world.

        Args:
            view: of the place.
            middle, size: metres.
            outline, hidden: (H, W) bool over the whole view; None for nothing.
        """
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
            return SETTINGS.cap_lab
        drawn = to_lab(as_bright(drawing, sight.picture, sight.hidden).astype(np.uint8))
        seen = np.minimum(distance(sight.lab, drawn), SETTINGS.cap_lab)
        apart = np.where(sight.hidden, SETTINGS.hidden_lab, seen)[drawing.covered].mean()
        costs.append(apart + SETTINGS.unfilled_lab * (sight.outline & ~drawing.covered).sum() / drawing.covered.sum())
    return float(np.mean(costs))


def refined(
    pose: np.ndarray,
    least: float,
    unlike: Callable[[np.ndarray], float],
    rounds: int = 5,
) -> tuple[float, np.ndarray]:
    """The least cost near (3,) x, y and heading, and where it is."""
    steps = np.array(SETTINGS.steps)
    for _ in range(rounds):
        around = [pose + sign * steps * axis for axis in np.eye(3) for sign in (1, -1)]
        value, nearby = min(((unlike(p), tuple(p)) for p in around), key=lambda found: found[0])
        pose, least, steps = (np.array(nearby), value, steps) if value < least else (pose, least, steps / 2)
    return least, pose
