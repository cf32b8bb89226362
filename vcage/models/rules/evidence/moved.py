"""Evidence of an object that was put down on the table, pushed, shown to the customer, or put back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from vcage.goals.centred import off_centre
from vcage.goals.in_place_of import off_place
from vcage.goals.moved_away import outwards
from vcage.goals.row_left_of import in_row
from vcage.goals.thresholds import THRESHOLDS
from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.evidence.judgement import LEFT_SHARE, LOOKS_SHARE, Judged, decided, refused, unseen
from vcage.models.rules.evidence.support import SETTINGS as SUPPORT
from vcage.models.rules.pixels import changed_between, looks_like, share_of
from vcage.models.rules.standing import SETTINGS as STANDING
from vcage.models.rules.standing import Sought, Standing
from vcage.plans.relations import holds
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.vision.colour import smoothed
from vcage.vision.protocols import View


@dataclass(frozen=True)
class MovedSettings:
    """Limits for a yes about where an object was and is.

    Args:
        slid_m: an object seen farther than this from its old place was moved, though it may cover part of that place.
        greyish_lab: an area less like an object than this may only be its edges.
        bare_share: share of the outline of an object on the table that must have been empty table before.
        seen_m: a place is seen with this error.
        facing_rad: largest angle between the seen direction of a front and the customer.
    """

    slid_m: float = 0.02
    greyish_lab: float = 5.0
    bare_share: float = 0.8
    facing_rad: float = np.radians(40)
    seen_m: float = 0.01


SETTINGS = MovedSettings()


@dataclass(frozen=True)
class Moved:
    """Measurements of an object that was moved, all from pixels.

    Args:
        left: share of its old outline that has changed; for a push, of the part it left.
        old, new: its old and new place; None where it is not found.
        bare: share of its new outline that was empty table before.
        alike: share of what came to be seen there that looks like it; of what has the table's colour the share of
            the evidence for a drawing of it.
    """

    left: float
    old: Standing | None
    new: Standing | None
    bare: float
    alike: float

    @classmethod
    def of(cls, view: CriticView, name: str) -> Moved:
        """Find an object before and after among what has changed; once for each question."""
        return view.once(("moved", name), lambda: cls._gather(view, name))

    @classmethod
    def _gather(cls, view: CriticView, name: str) -> Moved:
        was = view.sought(name)
        thing = view.stood_up(name) if name in view.question.stood_up else was
        before, after, change = view.before, view.after, view.change
        old = was.found(before, change.things)
        taken = view.nowhere if old is None else old.covered
        came = change.things & ~taken
        left = 0.0 if old is None else was.left(old, change.all, after["top"])
        slid = _slid(thing, old, after, change.all) if old is not None and left < LEFT_SHARE else None
        if old is not None and slid is not None:
            left = share_of(change.all, old.covered & ~slid.covered)
        new = slid or _come(thing, after, came, change.all & ~taken)
        here = new.covered & ~taken if new is not None else taken
        bare = 1 - share_of(view.stood_before, here) if here.any() else 0.0
        return cls(
            left=left, old=old, new=new, bare=bare, alike=_alike(view, thing, new, came & here, thing is not was)
        )

    def verdict(self, thing: str) -> Verdict:
        """Judge whether the object left its place and stands on the bare table."""
        if self.old is None or self.left < LEFT_SHARE:
            return refused(f"the {thing} still lies where it was", 1 - self.left, "lost")
        if self.new is None or self.alike < LOOKS_SHARE:
            return refused(f"the {thing} left its place and is not found on the table", 0.7, "lost")
        seen = f"the {thing} left its place, and {100 * self.bare:.0f} % of where it is now was empty table"
        enough = self.bare >= SETTINGS.bare_share
        return decided(enough, seen, 0.5 + abs(self.bare - SETTINGS.bare_share), "astray")


def judge_moved(view: CriticView, goal: Goal) -> Judged:
    """Judge whether an object was put down on the table."""
    moved = Moved.of(view, goal.subject)
    return Judged(moved.verdict(view.phrase(goal.subject)), view.around(moved.old, moved.new))


def judge_related(view: CriticView, goal: Goal) -> Judged:
    """Judge if an object was put down or pushed to its intended place beside another."""
    moved, thing = Moved.of(view, goal.subject), view.phrase(goal.subject)
    verdict, explained = judge_moved(view, goal)
    if not verdict.accepted or moved.new is None:
        return Judged(verdict, explained)
    other = replace(view.stood_up(str(goal.reference)), taken=moved.new.covered)
    word = goal.relation.replace("_", " ")
    reference = other.found(view.after)
    if reference is None or reference.unlike > STANDING.unlike_lab:
        unfound = f"the {other.look.phrase} is not found, so that nothing is told to be {word} it"
        return Judged(refused(unfound, 0.6), explained)
    there = (
        in_row(moved.new.aabb, reference.aabb, -SETTINGS.seen_m)
        if goal.relation == "row_left_of"
        else holds(goal.relation, moved.new.aabb, reference.aabb)  # pyrefly: ignore[bad-argument-type]
    )
    seen = f"the {thing} left its place and is {'' if there else 'not '}seen {word} the {other.look.phrase}"
    return Judged(decided(there, seen, 0.8, "astray"), explained)


def judge_centred(view: CriticView, goal: Goal) -> Judged:
    """Judge whether an object was put down at the centre of the table."""
    moved, thing = Moved.of(view, goal.subject), view.phrase(goal.subject)
    verdict, explained = judge_moved(view, goal)
    if not verdict.accepted or moved.new is None:
        return Judged(verdict, explained)
    away = off_centre(moved.new.aabb)
    seen = f"the {thing} left its place and is seen {100 * away:.0f} cm from the centre of the table"
    return Judged(decided(away <= THRESHOLDS.centred_m, seen, 0.8, "astray"), explained)


def judge_presented(view: CriticView, goal: Goal) -> Judged:
    """Judge whether an object was put on the customer's half of the table with its front to the customer; or anywhere
    with its front to the robot."""
    moved, thing = Moved.of(view, goal.subject), view.phrase(goal.subject)
    verdict, explained = judge_moved(view, goal)
    held = any(one.subject == goal.subject and one.reference in view.question.planned for one in view.question.goals)
    if moved.new is None or not (verdict.accepted or held):  # another goal tells whether it is in or on a thing
        return Judged(verdict, explained)
    who = "customer" if goal.relation == "presented" else "robot"
    stands, towards = moved.new.pose, np.array(view.question.towards_customer) * (1 if who == "customer" else -1)
    if who == "customer" and stands.p @ towards < 0:
        return Judged(refused(f"the {thing} is not on the customer's half of the table", 0.8, "astray"), explained)
    angle = float(np.arccos(np.clip(-stands.rotation()[:, 1] @ towards, -1, 1)))
    seen = f"the front of the {thing} is seen {np.degrees(angle):.0f}° from the {who}"
    limit = SETTINGS.facing_rad
    return Judged(decided(angle <= limit, seen, 0.5 + min(0.5, abs(angle - limit)), "astray"), explained)


def judge_moved_away(view: CriticView, goal: Goal) -> Judged:
    """Judge whether an object was put down farther out on its side of the table."""
    moved, thing = Moved.of(view, goal.subject), view.phrase(goal.subject)
    verdict, explained = judge_moved(view, goal)
    if not verdict.accepted or moved.new is None:
        return Judged(verdict, explained)
    started = view.sought(goal.subject).found(view.start) if "top" in view.start else moved.old
    if started is None:
        return Judged(refused(f"the {thing} is not found at the start", 0.6), explained)
    far = outwards(started.pose.p, moved.new.pose.p)
    seen = f"the {thing} is seen {100 * far:.0f} cm farther out than it stood"
    return Judged(decided(far >= THRESHOLDS.away_m - SETTINGS.seen_m, seen, 0.8, "astray"), explained)


def judge_in_place_of(view: CriticView, goal: Goal) -> Judged:
    """Judge whether an object was put down where another one stood at the start."""
    moved, thing = Moved.of(view, goal.subject), view.phrase(goal.subject)
    verdict, explained = judge_moved(view, goal)
    if not verdict.accepted or moved.new is None:
        return Judged(verdict, explained)
    other = view.sought(str(goal.reference))
    stood = other.found(view.start) if "top" in view.start else None
    if stood is None:
        return Judged(refused(f"the {other.look.phrase} is not found at the start", 0.6), explained)
    away = off_place(moved.new.aabb, stood.aabb)
    seen = f"the {thing} is seen {100 * away:.1f} cm from where the {other.look.phrase} stood"
    return Judged(decided(away <= THRESHOLDS.swapped_m + SETTINGS.seen_m, seen, 0.8, "astray"), explained)


def _alike(view: CriticView, thing: Sought, new: Standing | None, came: np.ndarray, by_drawing: bool) -> float:
    """Share of the newly visible area (H, W) at an object's place that looks like it.

    An object that was stood up shows another side there: for it, the share of the evidence for its drawing.
    """
    after = view.after["top"]
    seen = smoothed(after.picture)[came]
    # What has the table's colour changes it as a shadow does.
    if new is not None and (by_drawing or len(seen) < SUPPORT.fewest_px):
        share, pixels = thing.speaks(new, after, view.before["top"].picture)
        return share if pixels >= SUPPORT.fewest_px and share >= SUPPORT.shown_share else 0.0
    return float(looks_like(thing.look, seen).mean()) if len(seen) else 0.0


def _come(thing: Sought, after: Mapping[str, View], came: np.ndarray, changed: np.ndarray) -> Standing | None:
    """The place of an object among what came (H, W), or among all that changed: as grey as the table, it looks like its
    shadow."""
    new = thing.standing(after, came)
    if new is not None and new.unlike <= SETTINGS.greyish_lab:
        return new
    grey = thing.standing(after, changed)
    return min((one for one in (new, grey) if one is not None), key=lambda one: one.unlike, default=None)


def _slid(thing: Sought, old: Standing, after: Mapping[str, View], change: np.ndarray) -> Standing | None:
    """Find an object pushed by less than its size, which still covers a part of its old place; None
    for one at its old place."""
    new = thing.standing(after, change | old.covered)
    return new if new is not None and np.linalg.norm(new.pose.p - old.pose.p) > SETTINGS.slid_m else None


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

    @classmethod
    def gather(cls, view: CriticView, name: str) -> Returned | None:
        """Measure whether an object is again where it stood; None where it is not found at the start."""
        thing, start, before, after = view.sought(name), view.start["top"], view.before["top"], view.after["top"]
        stood = thing.standing(view.start, changed_between(start, before))
        if stood is None or not stood.covered.any():
            return None
        change = changed_between(before, after)
        came, differs = change[stood.covered].mean(), changed_between(start, after)[stood.covered].mean()
        now = thing.standing(view.after, change)
        off = np.inf if now is None else float(np.linalg.norm(now.pose.p - stood.pose.p))
        was = thing.standing(view.before, change & ~stood.covered)
        return cls(float(came), float(1 - differs), off, stood, was)

    def verdict(self, thing: str, same_share: float = 0.6, near_m: float = 0.02) -> Verdict:
        """Judge whether it is again where it stood.

        Args:
            thing: in words.
            same_share: share of its outline at the start that must look so again.
            near_m: an object seen no farther from where it stood is back, though its label may be turned away.
        """
        if self.came < LEFT_SHARE:
            return refused(f"nothing came back to where the {thing} stood", 1 - self.came, "lost")
        seen = f"{100 * self.same:.0f} % of where the {thing} stood looks as at the start"
        if self.off <= near_m:
            return decided(True, f"the {thing} is seen {100 * self.off:.0f} cm from where it stood, and {seen}", 0.8)
        return decided(self.same >= same_share, seen, 0.5 + abs(self.same - same_share))


def judge_returned(view: CriticView, goal: Goal) -> Judged:
    """Judge whether an object was put back."""
    thing = view.phrase(goal.subject)
    if "top" not in view.start:
        return unseen(view, f"where the {thing} stood at the start")
    evidence = Returned.gather(view, goal.subject)
    if evidence is None:
        return Judged(refused(f"where the {thing} stood at the start is not found", 0.6), view.nowhere)
    return Judged(evidence.verdict(thing), view.around(evidence.stood, evidence.was))
