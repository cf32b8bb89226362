"""Measure where an object and its receptacle stood and stand, and what came to be seen around them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.models.rules.critic_view import VIEW
from vcage.models.rules.evidence.support import Lying, Support, faintly_changed
from vcage.models.rules.pixels import Change, changed, grown, looks_like
from vcage.models.rules.standing import Sought, Standing
from vcage.vision.colour import smoothed
from vcage.vision.protocols import View


@dataclass(frozen=True)
class PlacedSettings:
    """Measures of a receptacle and its surroundings, and limits for a yes.

    Args:
        edge_px: margin around the possible places of an object in which it may be seen.
        border_px: a change this near to the look-alike area belongs to it.
        nearby_px: an object this near to its receptacle was brought to it and is not in or on it.
        moving: a receptacle may have moved a little if more than this many times the object's area changed in it.
        farthest_px: by so much at most, along each side of the picture.
        plain_share: share of the object's area that came to be seen, and of that looks like it, below which a drawing
            must be seen.
        hardly_share: share of the object's area that must be seen at first; with less, and as much change, it is
            looked for.
        like_lab: largest colour distance to a drawing of an object with the colours of its support.
        inside_share, on_share: share of the object's area that must be seen in, or on, the receptacle; walls and other
            contents hide some.
        mostly_share: share of the look-alike area around the receptacle that must be at the target.
        nearly_all_share, well_in_m: that share if the middle is nearer to the edge than this: it may well balance
            there.
        stirred_share: a receptacle with more change than this share, and no more of the object visible, was knocked
            over.
        shifted_m: a receptacle that moved farther was knocked away.
        beside_share: share of an object's area that must be seen beside a receptacle for it to have been brought there.
    """

    edge_px: float = 3.0
    border_px: int = 4
    nearby_px: int = 40
    moving: float = 1.2
    farthest_px: int = 16
    plain_share: float = 0.5
    hardly_share: float = 0.4
    like_lab: float = 9.0
    inside_share: float = 0.2
    on_share: float = 0.4
    mostly_share: float = 0.6
    nearly_all_share: float = 0.9
    well_in_m: float = 0.025
    stirred_share: float = 0.27
    shifted_m: float = 0.05
    beside_share: float = 0.2


SETTINGS = PlacedSettings()


@dataclass(frozen=True)
class Places:
    """The places of an object and its receptacle, in views with the receptacle in all of them.

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
        return grown(self.room, SETTINGS.edge_px)

    @cached_property
    def wide(self) -> np.ndarray:
        """(H, W) bool, the receptacle before and after, and its surroundings."""
        return grown(self.room | self.stands.covered | self.now.covered, VIEW.around_px)

    @property
    def area(self) -> int:
        """Pixels that the object covered before."""
        return max(1, int(self.old.covered.sum()))


def came_to(places: Places, before: View, after: View, thing: Sought) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Divide the newly visible area around a receptacle into look-alikes of an object and other changes:
    (H, W) bool each."""
    change, here = places.change, places.here
    came = change.things & ~grown(places.old.covered, VIEW.around_px) & places.wide
    alike = np.zeros_like(came)
    alike[came] = looks_like(thing.look, smoothed(after.picture)[came])
    stirred = came & ~grown(alike, SETTINGS.border_px)
    if (came & here).sum() > SETTINGS.moving * places.area:
        came = besides_shift(before.picture, after.picture, came)
        alike &= came
    if (alike & here).sum() < SETTINGS.hardly_share * places.area:
        # An object of its support's colours changes the picture as little as a shadow: only a drawing tells.
        lies = places.lies
        if lies is None and faintly_changed(before, after, here, SETTINGS.hardly_share * places.area):
            lies = places.drawn
        if lies is not None and lies.standing.unlike <= SETTINGS.like_lab and lies.seen:
            came, alike = came | lies.standing.covered, alike | lies.standing.covered
            stirred = stirred & ~lies.standing.covered
    return came, alike, stirred


def about(mask: np.ndarray) -> np.ndarray:
    """(H, W) bool: a mask and its surroundings, in a square, which is a hundred times as fast as a circle."""
    side = 2 * SETTINGS.nearby_px + 1
    return cv2.dilate(mask.astype(np.uint8), np.ones((side, side), np.uint8)).astype(bool)


def besides_shift(before: np.ndarray, after: np.ndarray, change: np.ndarray) -> np.ndarray:
    """The rest of a change (H, W) bool between two pictures (H, W, 3) that a small shift of something does not explain:
    the hand shifts a drawer that it meets."""
    v, u = (slice(axis.min(), axis.max() + 1) for axis in np.nonzero(change))
    wider = cv2.copyMakeBorder(before, *(SETTINGS.farthest_px,) * 4, cv2.BORDER_REPLICATE)
    wider = wider[v.start : v.stop + 2 * SETTINGS.farthest_px, u.start : u.stop + 2 * SETTINGS.farthest_px]
    differs = cv2.matchTemplate(wider, after[v, u], cv2.TM_SQDIFF, mask=change[v, u].astype(np.uint8))
    du, dv = cv2.minMaxLoc(differs)[2]
    return change & changed(
        smoothed(np.roll(before, (SETTINGS.farthest_px - dv, SETTINGS.farthest_px - du), (0, 1))),
        smoothed(after),
    )


def margin_of(alike: np.ndarray, rooms: np.ndarray, pose: Pose, camera: Camera) -> float:
    """Distance of the middle of a mask (H, W) inside rooms (n, 8, 3), in the frame of something at a pose, metres."""
    if not alike.any():
        return -np.inf
    middle = np.argwhere(alike).mean(axis=0)[::-1] + 0.5
    margins = []
    for corners in rooms:
        at = pose.inverse().apply(camera.unproject(middle[None], float(pose.apply(corners)[:, 2].min())))[0]
        margins.append(float((np.ptp(corners, axis=0) / 2 - np.abs(at - corners.mean(axis=0)))[:2].min()))
    return max(margins)


def reaching(mask: np.ndarray, room: np.ndarray) -> np.ndarray:
    """(H, W) bool: the patches of a mask that reach into a room: contents may hang out of it."""
    labels = cv2.connectedComponents(mask.astype(np.uint8), connectivity=8)[1]
    return np.isin(labels, np.setdiff1d(labels[room], 0))


def covered_by(rooms: np.ndarray, pose: Pose, camera: Camera) -> np.ndarray:
    """(H, W) bool: where a camera sees rooms (n, 8, 3) in the frame of something at a pose."""
    mask = np.zeros((camera.height, camera.width), np.uint8)
    for corners in rooms:
        pixels = np.round(camera.project(pose.apply(corners))).astype(np.int32)
        cv2.fillConvexPoly(mask, cv2.convexHull(pixels), (1,))
    return mask.astype(bool)
