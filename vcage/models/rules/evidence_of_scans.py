"""Measure in pictures how an object is held before a scanner, or a scanner before an object."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.models.rules.drawings import Draw, as_bright, cut, drawn_whole, inside, window_around
from vcage.models.rules.evidence import LEFT, changed_between, share_of
from vcage.models.rules.standing import Standing, refined
from vcage.vision.colour import distance, smoothed, to_lab
from vcage.vision.protocols import View

ALIKE = 14.0
"""Colour distance below which a pixel is like the drawing of an object."""

AWAY, DIRECTIONS, HEADINGS = (0.1, 0.16), 8, 4
"""How far from where a code is read, metres, in how many directions and at how many headings what is held may be seen
instead."""

HIDDEN = 0.4
"""How much a pixel that shows something else, such as the hand, speaks against what is drawn there."""

IN_FRONT = 0.005
"""An object nearer to the camera by less than this hides nothing, metres."""


@dataclass(frozen=True)
class Shown:
    """Measurements of a scan.

    Args:
        left: share of the old outline of what was moved that has changed at the moment, where least of it did: a hand
            before it hides it from one side.
        seen: share of what tells of a drawing of it, held so that the code is read, that speaks for it at the moment.
        elsewhere: the same where it is likeliest among places too far away and headings at which nothing is read.
    """

    left: float
    seen: float
    elsewhere: float


def gather_shown(
    before: Mapping[str, View],
    moment: Mapping[str, View],
    moved: Standing,
    still: Standing,
    draw_moved: Draw,
    draw_still: Draw,
    readings: Callable[[Pose, Pose], Iterable[Pose]],
) -> Shown:
    """Measure whether one object is held so before another that a code is read.

    Args:
        before, moment: views by camera.
        moved, still: where the two stood before.
        draw_moved, draw_still: draw them.
        readings: poses of what is moved at which it reads or is read, from where both stand.
    """
    sights = [_Held.of(before[name], moment[name], still, draw_still) for name in sorted(before.keys() & moment.keys())]
    left = min(share_of(sight.change, drawn_whole(draw_moved, moved.pose, sight.camera).covered) for sight in sights)
    if left < LEFT:
        return Shown(left, 0.0, 0.0)

    def unseen(pose: Pose) -> float:
        return 1 - _seen(pose, moved, sights, draw_moved)

    found = [(unseen(pose), pose) for pose in readings(moved.pose, still.pose)]
    least, pose = min(found, key=lambda one: one[0], default=(1.0, moved.pose))
    nearby, _ = refined(np.zeros(3), least, lambda shift: unseen(_shifted(pose, shift)))
    turned = [_shifted(pose, np.array([0.0, 0.0, turn])) for turn in _TURNS[1:]]
    others = [*turned, *(_shifted(pose, np.array([*away, turn])) for away in _AWAY for turn in _TURNS)]
    return Shown(left, 1 - nearby, 1 - min(map(unseen, others)))


_TURNS = np.linspace(0, 2 * np.pi, HEADINGS, endpoint=False)
_AWAY = [
    (far * np.cos(angle), far * np.sin(angle))
    for far in AWAY
    for angle in np.linspace(0, 2 * np.pi, DIRECTIONS, endpoint=False)
]


@dataclass(frozen=True)
class _Held:
    """A view of the moment, and what hides things in it.

    Args:
        camera: took it.
        picture: (H, W, 3) uint8.
        lab: (H, W, 3) the same, smoothed.
        change: (H, W) bool, since before.
        nearest: (H, W) float32, depth of the object that stays, where it is.
    """

    camera: Camera
    picture: np.ndarray
    lab: np.ndarray
    change: np.ndarray
    nearest: np.ndarray

    @classmethod
    def of(cls, before: View, moment: View, still: Standing, draw: Draw) -> _Held:
        lab = smoothed(moment.picture)
        return cls(
            moment.camera, moment.picture, lab, changed_between(before, moment), _depth(draw, still.pose, moment.camera)
        )


def _depth(draw: Draw, pose: Pose, camera: Camera) -> np.ndarray:
    """(H, W) how far what an object covers is away along a camera's axis, metres; inf elsewhere."""
    drawing = drawn_whole(draw, pose, camera)
    return np.where(drawing.covered, drawing.depth, np.inf).astype(np.float32)


def _shifted(pose: Pose, shift: np.ndarray) -> Pose:
    """A pose moved along x and y and turned upright by (3,)."""
    return Pose(pose.p + [shift[0], shift[1], 0.0], (Pose.from_yaw([0, 0, 0], float(shift[2])) * Pose(q=pose.q)).q)


def _seen(pose: Pose, moved: Standing, sights: Sequence[_Held], draw: Draw) -> float:
    """Share of what tells of the drawing of an object at a pose that speaks for it: pixels that have come to look like
    it, beside those that still show what was there before; what something else hides tells little."""
    found, against, drawn = 0, 0, 0
    for sight in sights:
        middle = pose.p + np.array([0.0, 0.0, moved.size[2] / 2])
        window = window_around(middle, moved.size, sight.camera)
        drawing = draw(pose, sight.camera, window)
        shown = (
            drawing.covered & inside(sight.picture, window) & (cut(sight.nearest, window) > drawing.depth - IN_FRONT)
        )
        if not shown.any():
            continue
        like = to_lab(as_bright(drawing, cut(sight.picture, window)).astype(np.uint8))
        alike = distance(cut(sight.lab, window), like) < ALIKE
        change = cut(sight.change, window)
        found += int((shown & alike & change).sum())
        against += int((shown & ~change).sum())
        drawn += int(shown.sum())
    return found / (found + against + HIDDEN * (drawn - found - against)) if found else 0.0
