"""Drawings of an object beside pictures of it: the part that they cover, the light, and how unlike they are."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.sim.drawer import Drawing, Window
from vcage.vision.colour import distance, smoothed, to_lab
from vcage.vision.protocols import View

Draw = Callable[[Pose, Camera, Window], Drawing]
"""An object alone at a pose, as a camera sees it through a window."""


def drawn_whole(draw: Draw, pose: Pose, camera: Camera, step: int = 1) -> Drawing:
    """A drawing of an object in all of a camera's picture, as large as that, or smaller by a factor ``step``."""
    height, width = camera.height // step, camera.width // step
    drawing = draw(pose, camera, Window(0, 0, max(height, width), step))
    return Drawing(*(layer[:height, :width] for layer in (drawing.picture, drawing.covered, drawing.depth)))


def window_around(middle: np.ndarray, size: Sequence[float], camera: Camera) -> Window:
    """The part of a camera's picture that an object of a size may cover, its middle (3,) in the world."""
    away = float(np.linalg.norm(camera.pose.p - middle))
    side = int(np.ceil(1.3 * float(np.linalg.norm(size)) * camera.focal / away)) + 16
    left, top = np.round(camera.project(middle[None])[0] - side / 2).astype(int)
    return Window(int(left), int(top), side, 1)


def cut(picture: np.ndarray, window: Window) -> np.ndarray:
    """Cut a window out of a picture; black outside it."""
    shown = np.zeros((window.side, window.side, *picture.shape[2:]), picture.dtype)
    (v0, v1), (u0, u1) = (
        np.clip([start, start + window.side], 0, end)
        for start, end in zip((window.top, window.left), picture.shape, strict=False)
    )
    shown[v0 - window.top : v1 - window.top, u0 - window.left : u1 - window.left] = picture[v0:v1, u0:u1]
    return shown


def inside(picture: np.ndarray, window: Window) -> np.ndarray:
    """(side, side) bool: the part of a window inside its picture."""
    return cut(np.ones(picture.shape[:2], bool), window)


@dataclass(frozen=True)
class LightRange:
    """How a picture may be lit, beside a drawing.

    Args:
        level: least and most by which it may be brighter.
        tint: the same of one colour beside the others.
    """

    level: tuple[float, float] = (0.5, 2.0)
    tint: tuple[float, float] = (0.85, 1.18)


ANY_LIGHT = LightRange()


def brightness(
    drawing: Drawing,
    picture: np.ndarray,
    hidden: np.ndarray | None = None,
    light: LightRange = ANY_LIGHT,
    samples_px: int = 1000,
) -> np.ndarray:
    """(3,) by which a drawing is multiplied to be as bright as a picture is where it is covered and not hidden.

    Args:
        drawing, picture: (side, side, 3) each.
        hidden: (side, side) bool.
        light: in which the picture may be taken.
        samples_px: number of pixels to measure the brightness with.
    """
    covered = drawing.covered if hidden is None else drawing.covered & ~hidden
    if not covered.any():
        return np.ones(3, np.float32)
    some = slice(None, None, 1 + int(covered.sum()) // samples_px)
    gain = np.median((picture[covered][some] + 4.0) / (drawing.picture[covered][some] + np.float32(4.0)), axis=0)
    level = float(np.median(gain))
    return np.clip(level, *light.level) * np.clip(gain / max(level, 1e-3), *light.tint)


def as_bright(
    drawing: Drawing, picture: np.ndarray, hidden: np.ndarray | None = None, light: LightRange = ANY_LIGHT
) -> np.ndarray:
    """(side, side, 3) float32, a drawing as bright as a picture is where it is covered and not hidden, see
    :func:`brightness`."""
    return np.clip(drawing.picture.astype(np.float32) * brightness(drawing, picture, hidden, light), 0, 255)


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
        outline: (side, side) bool, the area for a drawing to fill.
        hidden: (side, side) bool, the area hidden by something else.
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
        """Cut the possible area of an object of a size (3,) out of a view, its middle (3,) in the world.

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
        covered = drawing.covered
        if not covered.any():
            return SETTINGS.cap_lab
        gain = brightness(drawing, sight.picture, sight.hidden)
        lit = np.clip(drawing.picture[covered].astype(np.float32) * gain, 0, 255).astype(np.uint8)
        seen = np.minimum(distance(sight.lab[covered], to_lab(lit[:, None])[:, 0]), SETTINGS.cap_lab)
        apart = np.where(sight.hidden[covered], SETTINGS.hidden_lab, seen).mean()
        costs.append(apart + SETTINGS.unfilled_lab * (sight.outline & ~covered).sum() / covered.sum())
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
