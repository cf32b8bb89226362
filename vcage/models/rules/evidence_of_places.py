"""What pictures show of an object that was put down on the table, shown, handed over or held before a scanner."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.models.rules.change import Change
from vcage.models.rules.drawings import Draw, as_bright, cut, drawn_whole, inside, window_around
from vcage.models.rules.evidence import changed, salience
from vcage.models.rules.evidence_of_placing import looks_like
from vcage.models.rules.evidence_of_support import SETTINGS
from vcage.models.rules.standing import Sought, Standing, refined
from vcage.vision.colour import distance, smoothed, to_lab
from vcage.vision.protocols import View

LEFT = 0.5
"""Share of the old outline of what was moved that must have changed."""

ALIKE = 14.0
"""Colour distance below which a pixel is like the drawing of an object."""

AWAY, DIRECTIONS, HEADINGS = (0.1, 0.16), 8, 4
"""How far from where a code is read, metres, in how many directions and at how many headings what is held may be seen
instead."""

GREYISH = 5.0
"""What is less like an object than this may only be its edges."""

HIDDEN = 0.4
"""How much a pixel that shows something else, such as the hand, speaks against what is drawn there."""

EDGE = 0.35
"""Depth of the strip on the robot's side of the view from above, as a share of its height."""

IN_FRONT = 0.005
"""What is nearer to the camera by less than this hides nothing, metres."""


@dataclass(frozen=True)
class Moved:
    """Measurements of an object that was moved, all from pixels.

    Args:
        left: share of its old outline that has changed.
        old, new: where it stood and stands; None where it is not found.
        bare: share of its new outline that was empty table before.
        alike: share of what came to be seen there that looks like it; of what has the table's colour the share of
            what tells a drawing of it from the table.
    """

    left: float
    old: Standing | None
    new: Standing | None
    bare: float
    alike: float


def gather_moved(
    before: Mapping[str, View],
    after: Mapping[str, View],
    thing: Sought,
) -> Moved:
    """Where an object was, and where it is now: among what has changed.

    Args:
        before, after: views of one moment each, by camera.
        thing: the object.
    """
    change = Change.between(before["top"], after["top"])
    old = thing.found(before, change.things)
    taken = np.zeros_like(change.all) if old is None else old.covered
    came = change.things & ~taken
    new = thing.standing(after, came)
    if new is None or new.unlike > GREYISH:  # what is as grey as the table looks like its shadow
        grey = thing.standing(after, change.all & ~taken)
        new = min((one for one in (new, grey) if one is not None), key=lambda one: one.unlike, default=None)
    stood = salience(before["top"].picture, thing.background) > 0.5
    here = new.covered & ~taken if new is not None else taken
    seen = smoothed(after["top"].picture)[came & here]
    alike = float(looks_like(thing.look, seen).mean()) if len(seen) else 0.0
    if new is not None and len(seen) < SETTINGS.fewest_px:  # what has the table's colour changes it as a shadow does
        share, pixels = thing.speaks(new, after["top"], before["top"].picture)
        alike = share if pixels >= SETTINGS.fewest_px and share >= SETTINGS.shown_share else 0.0
    return Moved(
        left=0.0 if old is None else thing.left(old, change.all, after["top"]),
        old=old,
        new=new,
        bare=1 - _share(stood, here) if here.any() else 0.0,
        alike=alike,
    )


@dataclass(frozen=True)
class Returned:
    """Measurements of an object that was put back.

    Args:
        came: share of its outline at the start that changed when it was put there.
        same: share of it that looks as at the start.
        off: how far it is seen from there, metres; inf where it is not found.
        stood, was: where it stood at the start, and before it was put back.
    """

    came: float
    same: float
    off: float
    stood: Standing
    was: Standing | None


def gather_returned(
    start: Mapping[str, View],
    before: Mapping[str, View],
    after: Mapping[str, View],
    thing: Sought,
) -> Returned | None:
    """Whether an object is again where it stood at the start; None where it is not found there.

    Args:
        start: views of the start of the episode.
        before, after, thing: see :func:`gather_moved`.
    """
    gone = _change(start["top"], before["top"])
    stood = thing.standing(start, gone)
    if stood is None or not stood.covered.any():
        return None
    came, differs = (_change(one["top"], after["top"])[stood.covered].mean() for one in (before, start))
    change = _change(before["top"], after["top"])
    now = thing.standing(after, change)
    off = np.inf if now is None else float(np.linalg.norm(now.pose.p - stood.pose.p))
    return Returned(float(came), float(1 - differs), off, stood, thing.standing(before, change & ~stood.covered))


def gather_restless(before: View, moment: View, after: View) -> float:
    """Share of what came or went since before that changed after the moment."""
    change = _change(before, after)
    return float(_change(moment, after)[change].mean()) if change.any() else 1.0


@dataclass(frozen=True)
class Handed:
    """Measurements of a hand-over.

    Args:
        left: share of the object's outline before that has changed at the moment.
        to_come: share of its outline afterwards that looks otherwise at the moment.
        arms: share of the picture's edge on the robot's side that changed since before, in its left and right half:
            each arm reaches in from its own side.
        old, new: where it stood and stands.
    """

    left: float
    to_come: float
    arms: tuple[float, float]
    old: Standing
    new: Standing


def gather_handed(
    before: Mapping[str, View],
    moment: Mapping[str, View],
    after: Mapping[str, View],
    thing: Sought,
) -> Handed | None:
    """Whether an object is neither here nor there while both arms reach out; None where it is not found.

    Args:
        before, moment, after, thing: see :func:`gather_moved`.
    """
    moved = gather_moved(before, after, thing)
    if moved.old is None or moved.new is None:
        return None
    since, until = (_change(one["top"], moment["top"]) for one in (before, after))
    things = Change.between(before["top"], moment["top"]).things  # an arm's shadow falls on the other one's side
    edge = things[-round(len(things) * EDGE) :]
    left, right = np.array_split(edge, 2, axis=1)
    return Handed(
        left=_share(since, moved.old.covered),
        to_come=_share(until, moved.new.covered),
        arms=(float(left.mean()), float(right.mean())),
        old=moved.old,
        new=moved.new,
    )


def _share(change: np.ndarray, outline: np.ndarray) -> float:
    return float(change[outline].mean()) if outline.any() else 0.0


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
    """Whether one object is held so before another that a code is read.

    Args:
        before, moment: views by camera.
        moved, still: where the two stood before.
        draw_moved, draw_still: draw them.
        readings: poses of what is moved at which it reads or is read, from where both stand.
    """
    sights = [_Held.of(before[name], moment[name], still, draw_still) for name in sorted(before.keys() & moment.keys())]
    left = min(_share(sight.change, drawn_whole(draw_moved, moved.pose, sight.camera).covered) for sight in sights)
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
        return cls(moment.camera, moment.picture, lab, _change(before, moment), _depth(draw, still.pose, moment.camera))


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


def _change(one: View, other: View) -> np.ndarray:
    """(H, W) bool."""
    return changed(smoothed(one.picture), smoothed(other.picture))
