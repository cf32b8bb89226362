"""Measure in pictures how an object was put down on the table, pushed, shown, put back or handed over."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from vcage.models.rules.change import Change
from vcage.models.rules.evidence import LEFT, changed_between, salience, share_of
from vcage.models.rules.evidence_of_placing import looks_like
from vcage.models.rules.evidence_of_support import SETTINGS
from vcage.models.rules.standing import Sought, Standing
from vcage.vision.colour import smoothed
from vcage.vision.protocols import View

SLID = 0.02
"""An object seen farther than this from where it stood was moved, though it may cover part of that place, metres."""

GREYISH = 5.0
"""What is less like an object than this may only be its edges."""

EDGE = 0.35
"""Depth of the strip on the robot's side of the view from above, as a share of its height."""


@dataclass(frozen=True)
class Moved:
    """Measurements of an object that was moved, all from pixels.

    Args:
        left: share of its old outline that has changed; of what was only pushed along, of the part that it left.
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
    left = 0.0 if old is None else thing.left(old, change.all, after["top"])
    slid = _slid(thing, old, after, change.all) if old is not None and left < LEFT else None
    if old is not None and slid is not None:
        left = share_of(change.all, old.covered & ~slid.covered)
    new = slid or _come(thing, after, came, change.all & ~taken)
    stood = salience(before["top"].picture, thing.background) > 0.5
    here = new.covered & ~taken if new is not None else taken
    seen = smoothed(after["top"].picture)[came & here]
    alike = float(looks_like(thing.look, seen).mean()) if len(seen) else 0.0
    if new is not None and len(seen) < SETTINGS.fewest_px:  # what has the table's colour changes it as a shadow does
        share, pixels = thing.speaks(new, after["top"], before["top"].picture)
        alike = share if pixels >= SETTINGS.fewest_px and share >= SETTINGS.shown_share else 0.0
    return Moved(
        left=left,
        old=old,
        new=new,
        bare=1 - share_of(stood, here) if here.any() else 0.0,
        alike=alike,
    )


def _come(thing: Sought, after: Mapping[str, View], came: np.ndarray, changed: np.ndarray) -> Standing | None:
    """Where an object stands among what came (H, W), or among all that changed: as grey as the table, it looks like its
    shadow."""
    new = thing.standing(after, came)
    if new is not None and new.unlike <= GREYISH:
        return new
    grey = thing.standing(after, changed)
    return min((one for one in (new, grey) if one is not None), key=lambda one: one.unlike, default=None)


def _slid(thing: Sought, old: Standing, after: Mapping[str, View], change: np.ndarray) -> Standing | None:
    """Where an object stands that was pushed by less than its size, and so still covers a part of where it stood; None
    for one that stands where it stood."""
    new = thing.standing(after, change | old.covered)
    return new if new is not None and np.linalg.norm(new.pose.p - old.pose.p) > SLID else None


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
    gone = changed_between(start["top"], before["top"])
    stood = thing.standing(start, gone)
    if stood is None or not stood.covered.any():
        return None
    came, differs = (changed_between(one["top"], after["top"])[stood.covered].mean() for one in (before, start))
    change = changed_between(before["top"], after["top"])
    now = thing.standing(after, change)
    off = np.inf if now is None else float(np.linalg.norm(now.pose.p - stood.pose.p))
    return Returned(float(came), float(1 - differs), off, stood, thing.standing(before, change & ~stood.covered))


def gather_restless(before: View, moment: View, after: View) -> float:
    """Share of what came or went since before that changed after the moment."""
    change = changed_between(before, after)
    return float(changed_between(moment, after)[change].mean()) if change.any() else 1.0


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
    since, until = (changed_between(one["top"], moment["top"]) for one in (before, after))
    things = Change.between(before["top"], moment["top"]).things  # an arm's shadow falls on the other one's side
    edge = things[-round(len(things) * EDGE) :]
    left, right = np.array_split(edge, 2, axis=1)
    return Handed(
        left=share_of(since, moved.old.covered),
        to_come=share_of(until, moved.new.covered),
        arms=(float(left.mean()), float(right.mean())),
        old=moved.old,
        new=moved.new,
    )
