"""What pictures show of an object that was put in or on another."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.models.protocols import THIN_SUPPORT_M
from vcage.models.rules.change import Change, grown
from vcage.models.rules.drawings import Draw
from vcage.models.rules.evidence import changed
from vcage.models.rules.evidence_of_support import (
    Lying,
    Support,
    faintly_changed,
    find_lying,
    find_support,
    redrawn,
    stands_on,
)
from vcage.models.rules.standing import Sought, Standing
from vcage.vision.colour import palette, palette_distance, smoothed, to_lab
from vcage.vision.protocols import Reference, View

ALIKE = 16.0
"""Colour distance to the object's palette below which a pixel may be the object's."""

AROUND = 8.0
"""So much around an outline belongs to it, pixels."""

EDGE = 3.0
"""So much around where an object may be it may be seen, pixels."""

BORDER = 4
"""Width of the strip along a receptacle's outline that shows whether it was moved, pixels."""

NEARBY = 40
"""So near to a receptacle lies what was brought to it and is not in or on it, pixels."""

MOVING = 1.2
"""Where more than so many times the object's area changed in its receptacle, that may have moved a little."""

PLAIN = 0.5
"""Share of the object's area that came to be seen, and of that looks like it, below which a drawing must be seen."""

HARDLY = 0.4
"""Share of the object's area that must be seen at once; where less is, and as much changed, it is looked for."""

LIKE = 9.0
"""Largest colour distance to a drawing of an object that has the colours of what it lies on."""

FARTHEST = 16
"""So far at most, pixels along each side of the picture."""


@dataclass(frozen=True)
class Placed:
    """Measurements, all from pixels.

    Args:
        left: share of the object's old outline that has changed.
        shifted: how far the receptacle moved, metres; inf where it is not found again.
        stirred: share of the receptacle that changed and does not look like the object.
        inside: what came to be seen where it should be, over the object's area.
        share: of what looks like the object around the receptacle, how much is where it should be.
        alike: share of what is there, or of as much as the object covers, that looks like it.
        beside: what came to be seen around the receptacle, far from where the object was, over the object's area.
        margin: how far inside the edge of where it should be the middle of what looks like it is, metres.
        explained: (H, W) bool, where the sub-task changes the picture.
        support_seen: the receptacle is seen; or it is thin, and the object hides it.
        plain: enough came to be seen that looks like the object; or else a drawing of it there is seen.
        aloft: share of what views from the side tell of the object at the height of its place that shows it there; None
            where none can tell.
    """

    left: float
    shifted: float
    stirred: float
    inside: float
    share: float
    alike: float
    beside: float
    margin: float
    explained: np.ndarray
    support_seen: bool = True
    plain: bool = True
    aloft: float | None = None


def gather_placed(
    before: Mapping[str, View],
    after: Mapping[str, View],
    thing: Sought,
    place: Sought,
    rooms: np.ndarray,
    unlike: float,
    others: Sequence[tuple[Draw, Pose]] = (),
) -> Placed | None:
    """Measure one sub-task: ``thing`` was to be put in or on ``place``; None where one of them is not found before.

    Args:
        before, after: views of one moment each, by camera.
        thing, place: the object and the receptacle, parts open as they are.
        rooms: (n, 8, 3) corners of where the object may be, in the receptacle's frame.
        unlike: colour distance from which on what stands somewhere is another object.
        others: what else stands there, by the plan.
    """
    change, camera = Change.between(before["top"], after["top"]), before["top"].camera
    stands = place.found(before)  # it may itself stand on another: only the side tells how high
    room = None if stands is None else _covered(rooms, stands.pose, camera)
    old = thing.found({"top": before["top"]}, change.all if room is None else change.all & ~room)
    if stands is None or room is None or old is None:
        return None

    def find(at: Standing, before: Mapping[str, View], room: np.ndarray) -> Lying | None:
        return find_lying(thing, rooms, at.pose, before, after, grown(room, EDGE), others)

    lies, support = None, Support(stands)
    if len(before.keys() & after.keys()) > 1 or not stands_on(place, stands, change, before["top"], after["top"]):
        lies = find(stands, before, room)
        support = find_support(place, stands, lies, change, before, after, unlike)
    now = support.now or stands
    if now is not stands:
        before = {**before, "top": redrawn(before["top"], place.background, stands, now)}
        change, room = Change.between(before["top"], after["top"]), _covered(rooms, now.pose, camera)
        lies = find(now, before, room)
    return _measured(
        _Places(old, stands, support, room, change, lies, lambda: find(now, before, room)),
        before["top"],
        after["top"],
        thing,
        place,
        rooms,
    )


@dataclass(frozen=True)
class _Places:
    """Where an object and its receptacle stood and stand, in views in which the receptacle was there all the time.

    Args:
        old: the object before.
        stands, support: the receptacle before and after.
        room: (H, W) bool, where the object should be.
        change: between the views from above.
        lies: the object in or on the receptacle; None where it was not looked for.
        find: looks for it there.
    """

    old: Standing
    stands: Standing
    support: Support
    room: np.ndarray
    change: Change
    lies: Lying | None
    find: Callable[[], Lying | None]

    @property
    def now(self) -> Standing:
        """The receptacle afterwards; before, where it is not found."""
        return self.support.now or self.stands

    @cached_property
    def drawn(self) -> Lying | None:
        """The object in or on the receptacle, looked for once where that was not done yet."""
        return self.lies or self.find()

    @cached_property
    def here(self) -> np.ndarray:
        """(H, W) bool, where the object may be seen that is where it should be."""
        return grown(self.room, EDGE)

    @cached_property
    def wide(self) -> np.ndarray:
        """(H, W) bool, the receptacle before and after, and what is around it."""
        return grown(self.room | self.stands.covered | self.now.covered, AROUND)

    @property
    def area(self) -> int:
        """Pixels that the object covered before."""
        return max(1, int(self.old.covered.sum()))


def _measured(places: _Places, before: View, after: View, thing: Sought, place: Sought, rooms: np.ndarray) -> Placed:
    """Measure what came to be seen in or on a receptacle, and around it.

    Args:
        places: where all stands.
        before, after: from above.
        thing, place, rooms: see :func:`gather_placed`.
    """
    old, now, change, lies = places.old, places.now, places.change, places.lies
    came, alike, stirred = _came(places, before, after, thing)
    if lies is not None and lies.seen and now is not places.stands:  # the rest is of the support, which moved
        came, alike = (mask & grown(lies.standing.covered, EDGE) for mask in (came, alike))
    here, wide, area = places.here, places.wide, places.area
    seen, size = max(1, int((came & here).sum())), float(np.hypot(*np.ptp(np.argwhere(old.covered), axis=0)))
    reaching = _reaching(change.things & ~old.covered, here) & grown(here, size / 2)
    near = change.things & _about(wide) & ~here & ~_about(old.covered)
    inside, like = float((came & here).sum()) / area, float((alike & here).sum()) / min(seen, area)
    doubtful = min(inside, like) < PLAIN
    shift = np.inf if places.support.now is None else float(np.linalg.norm(now.pose.p - places.stands.pose.p))
    return Placed(
        left=thing.left(old, change.all, after),
        shifted=shift,
        stirred=float(stirred[places.stands.covered].mean()) if places.stands.covered.any() else 0.0,
        inside=inside,
        share=float((alike & here).sum()) / max(1, int(alike.sum())),
        alike=like,
        beside=float(near.sum()) / area,
        margin=_margin(alike & here, rooms, now.pose, before.camera),
        explained=grown(old.covered, AROUND) | wide | grown(reaching, AROUND),
        support_seen=places.support.seen or place.look.size[2] < THIN_SUPPORT_M,
        plain=not doubtful or (places.drawn is not None and places.drawn.seen),
        aloft=None if lies is None else lies.aloft,
    )


def _came(places: _Places, before: View, after: View, thing: Sought) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Tell apart what came to be seen around a receptacle, what of it looks like an object, and what changed there and
    does not: (H, W) bool each. See :func:`_measured`."""
    change, here = places.change, places.here
    came = change.things & ~grown(places.old.covered, AROUND) & places.wide
    alike = np.zeros_like(came)
    alike[came] = looks_like(thing.look, smoothed(after.picture)[came])
    stirred = came & ~grown(alike, BORDER)
    if (came & here).sum() > MOVING * places.area:
        came = _besides_shift(before.picture, after.picture, came)
        alike &= came
    if (alike & here).sum() < HARDLY * places.area:
        # What has the colours of what it lies on changes as little as a shadow does: only a drawing tells.
        lies = places.lies
        if lies is None and faintly_changed(before, after, here, HARDLY * places.area):
            lies = places.drawn
        if lies is not None and lies.standing.unlike <= LIKE and lies.seen:
            came, alike = came | lies.standing.covered, alike | lies.standing.covered
            stirred = stirred & ~lies.standing.covered
    return came, alike, stirred


def _about(mask: np.ndarray) -> np.ndarray:
    """(H, W) bool: a mask and what is beside it, in a square, which is a hundred times as fast as a circle."""
    side = 2 * NEARBY + 1
    return cv2.dilate(mask.astype(np.uint8), np.ones((side, side), np.uint8)).astype(bool)


def _besides_shift(before: np.ndarray, after: np.ndarray, change: np.ndarray) -> np.ndarray:
    """What of a change (H, W) bool between two pictures (H, W, 3) is more than that something there was shifted a
    little, as a drawer is that the hand meets."""
    v, u = (slice(axis.min(), axis.max() + 1) for axis in np.nonzero(change))
    wider = cv2.copyMakeBorder(before, *(FARTHEST,) * 4, cv2.BORDER_REPLICATE)
    wider = wider[v.start : v.stop + 2 * FARTHEST, u.start : u.stop + 2 * FARTHEST]
    differs = cv2.matchTemplate(wider, after[v, u], cv2.TM_SQDIFF, mask=change[v, u].astype(np.uint8))
    du, dv = cv2.minMaxLoc(differs)[2]
    return change & changed(
        smoothed(np.roll(before, (FARTHEST - dv, FARTHEST - du), (0, 1))),
        smoothed(after),
    )


def _margin(alike: np.ndarray, rooms: np.ndarray, pose: Pose, camera: Camera) -> float:
    """How far inside rooms (n, 8, 3) in the frame of something at a pose the middle of a mask (H, W) is, metres."""
    if not alike.any():
        return -np.inf
    middle = np.argwhere(alike).mean(axis=0)[::-1] + 0.5
    margins = []
    for corners in rooms:
        at = pose.inverse().apply(camera.unproject(middle[None], float(pose.apply(corners)[:, 2].min())))[0]
        margins.append(float((np.ptp(corners, axis=0) / 2 - np.abs(at - corners.mean(axis=0)))[:2].min()))
    return max(margins)


def _reaching(mask: np.ndarray, room: np.ndarray) -> np.ndarray:
    """(H, W) bool: the patches of a mask that reach into a room: what lies there may hang out of it."""
    labels = cv2.connectedComponents(mask.astype(np.uint8), connectivity=8)[1]
    return np.isin(labels, np.setdiff1d(labels[room], 0))


def _covered(rooms: np.ndarray, pose: Pose, camera: Camera) -> np.ndarray:
    """(H, W) bool: where a camera sees rooms (n, 8, 3) in the frame of something at a pose."""
    mask = np.zeros((camera.height, camera.width), np.uint8)
    for corners in rooms:
        pixels = np.round(camera.project(pose.apply(corners))).astype(np.int32)
        cv2.fillConvexPoly(mask, cv2.convexHull(pixels), (1,))
    return mask.astype(bool)


def looks_like(reference: Reference, lab: np.ndarray) -> np.ndarray:
    """(n,) bool: which of the pixels (n, 3) have one of a reference's main colours, in light or in shade."""
    if not len(lab):
        return np.zeros(0, bool)
    centres, shares = palette(to_lab(np.ascontiguousarray(reference.picture[..., :3]))[reference.picture[..., 3] > 200])
    centres = centres[shares > 0.08]
    return palette_distance(lab, np.concatenate([centres, centres * np.array([0.75, 0.85, 0.85])])) < ALIKE
