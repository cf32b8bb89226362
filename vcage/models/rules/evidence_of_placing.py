"""What pictures show of an object that was put in or on another."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.models.rules.change import Change, grown
from vcage.models.rules.standing import Sought
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

BESIDE = 40
"""So near to a receptacle lies what was brought to it and is not in or on it, pixels."""

STAYED = 0.5
"""A receptacle of whose border less than this changed stands where it stood."""


@dataclass(frozen=True)
class Placed:
    """Measurements, all from pixels.

    Args:
        left: share of the object's old outline that has changed.
        shifted: how far the receptacle moved, metres; inf where it is not found again.
        inside: what came to be seen where it should be, over the object's area.
        share: of what looks like the object around the receptacle, how much is where it should be.
        alike: share of what is there, or of as much as the object covers, that looks like it.
        beside: what came to be seen around the receptacle, far from where the object was, over the object's area.
        explained: (H, W) bool, where the sub-task changes the picture.
    """

    left: float
    shifted: float
    inside: float
    share: float
    alike: float
    beside: float
    explained: np.ndarray


def gather_placed(
    before: Mapping[str, View],
    after: Mapping[str, View],
    thing: Sought,
    place: Sought,
    rooms: np.ndarray,
    unlike: float,
) -> Placed | None:
    """Measure one sub-task: ``thing`` was to be put in or on ``place``; None where one of them is not found before.

    Args:
        before, after: views of one moment each, by camera.
        thing, place: the object and the receptacle, parts open as they are.
        rooms: (n, 8, 3) corners of where the object may be, in the receptacle's frame.
        unlike: colour distance from which on what stands somewhere is another object.
    """
    change = Change.between(before["top"], after["top"])
    camera = before["top"].camera
    stands = place.found({"top": before["top"]})
    room = None if stands is None else _covered(rooms, stands.pose, camera)
    old = thing.found(before, change.all if room is None else change.all & ~room)
    if stands is None or room is None or old is None:
        return None
    inner = cv2.erode(stands.covered.astype(np.uint8), np.ones((BORDER, BORDER), np.uint8)).astype(bool)
    border, shifted = stands.covered & ~inner, 0.0
    if border.any() and change.things[border].mean() > STAYED:
        now = place.standing({"top": after["top"]})
        shifted = np.inf
        if now is not None and now.unlike < unlike:
            shifted = float(np.linalg.norm(now.pose.p - stands.pose.p))
            room = _covered(rooms, now.pose, camera)
    wide = grown(room | stands.covered, AROUND)
    came = change.things & ~grown(old.covered, AROUND) & wide
    alike = np.zeros_like(came)
    alike[came] = looks_like(thing.look, smoothed(after["top"].picture)[came])
    here = grown(room, EDGE)
    near = change.things & _about(wide) & ~here & ~_about(old.covered)
    area, seen = max(1, int(old.covered.sum())), max(1, int((came & here).sum()))
    return Placed(
        left=float(change.all[old.covered].mean()) if old.covered.any() else 0.0,
        shifted=shifted,
        inside=float((came & here).sum()) / area,
        share=float((alike & here).sum()) / max(1, int(alike.sum())),
        alike=float((alike & here).sum()) / min(seen, area),
        beside=float(near.sum()) / area,
        explained=grown(old.covered, AROUND) | wide | grown(_reaching(change.things & ~old.covered, here), AROUND),
    )


def _about(mask: np.ndarray) -> np.ndarray:
    """(H, W) bool: a mask and what is beside it, in a square, which is a hundred times as fast as a circle."""
    side = 2 * BESIDE + 1
    return cv2.dilate(mask.astype(np.uint8), np.ones((side, side), np.uint8)).astype(bool)


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
