"""Drawings of an object beside pictures of it: which part of a picture they cover, and in its light."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.sim.drawer import Drawing, Window


@dataclass(frozen=True)
class BrightnessSettings:
    """Limits within which a drawing is made as bright as a picture.

    Args:
        samples_px: pixels by which the brightness is told.
        factor: least and most by which a picture may be brighter than a drawing.
        tint: the same of one colour beside the others.
    """

    samples_px: int = 1000
    factor: tuple[float, float] = (0.5, 2.0)
    tint: tuple[float, float] = (0.85, 1.18)


SETTINGS = BrightnessSettings()

Draw = Callable[[Pose, Camera, Window], Drawing]
"""An object alone at a pose, as a camera sees it through a window."""


def drawn_whole(draw: Draw, pose: Pose, camera: Camera) -> Drawing:
    """A drawing of an object in all of a camera's picture, as large as that."""
    drawing = draw(pose, camera, Window(0, 0, max(camera.width, camera.height), 1))
    layers = (drawing.picture, drawing.covered, drawing.depth)
    return Drawing(*(layer[: camera.height, : camera.width] for layer in layers))


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
    """(side, side) bool: what a window shows of a picture and not of what is beside it."""
    return cut(np.ones(picture.shape[:2], bool), window)


def brightness(drawing: Drawing, picture: np.ndarray, hidden: np.ndarray | None = None) -> np.ndarray:
    """(3,) by which a drawing is multiplied to be as bright as a picture is where it is covered and not hidden."""
    covered = drawing.covered if hidden is None else drawing.covered & ~hidden
    if not covered.any():
        return np.ones(3, np.float32)
    some = slice(None, None, 1 + int(covered.sum()) // SETTINGS.samples_px)
    gain = np.median((picture[covered][some] + 4.0) / (drawing.picture[covered][some] + np.float32(4.0)), axis=0)
    level = float(np.median(gain))
    return np.clip(level, *SETTINGS.factor) * np.clip(gain / max(level, 1e-3), *SETTINGS.tint)


def as_bright(drawing: Drawing, picture: np.ndarray, hidden: np.ndarray | None = None) -> np.ndarray:
    """(side, side, 3) float32, a drawing as bright as a picture is where it is covered and not hidden."""
    return np.clip(drawing.picture.astype(np.float32) * brightness(drawing, picture, hidden), 0, 255)
