"""Evidence of an object that was put in or on another, and of one that lay still on a scale."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.errors import InputFileError
from vcage.base.geometry import Pose
from vcage.models.protocols import THIN_SUPPORT_M
from vcage.models.rules.critic_view import VIEW, CriticView
from vcage.models.rules.drawings import Draw
from vcage.models.rules.evidence.judgement import LEFT_SHARE, LOOKS_SHARE, Judged, decided, refused, unseen
from vcage.models.rules.evidence.places import SETTINGS, Places, about, came_to, covered_by, margin_of, reaching
from vcage.models.rules.evidence.support import SETTINGS as SUPPORT
from vcage.models.rules.evidence.support import Lying, Support, find_lying, find_support, redrawn, stays
from vcage.models.rules.pixels import Change, changed, changed_between, grown
from vcage.models.rules.standing import Sought, Standing
from vcage.schema.episodes import Failure, Verdict
from vcage.schema.goals import Goal
from vcage.vision.colour import smoothed
from vcage.vision.protocols import View


@dataclass(frozen=True)
class Placed:
    """Measurements, all from pixels.

    Args:
        left: share of the object's old outline that has changed, even faintly.
        shifted: how far the receptacle moved, metres; inf where it is not found again.
        stirred: share of the receptacle that changed and does not look like the object.
        inside: newly visible area at the target, over the object's area.
        share: share at the target of the area around the receptacle that looks like the object.
        alike: share of the area there, or of the object's own area, that looks like it.
        beside: newly visible area around the receptacle, far from the object's old place, over the object's area.
        margin: distance of the middle of the look-alike area inside the edge of the target, metres.
        explained: (H, W) bool, changes by the sub-task.
        support_seen: the receptacle is seen; or it is thin, and the object hides it.
        plain: enough newly visible area looks like the object; or else a drawing of it there is seen.
        aloft: share of the evidence in side views that shows the object at the height of its place; None
            without evidence.
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

    @classmethod
    def gather(cls, view: CriticView, goal: Goal) -> Placed | None:
        """Measure a goal's subject in or on its reference; None where one of them is not found before.

        Raises:
            InputFileError: the question does not say where the subject may be.
        """
        question, reference = view.question, str(goal.reference)
        thing, place = view.sought(goal.subject), view.sought(reference, upon=True)
        if goal not in question.rooms:
            raise InputFileError(f"nothing says where in or on {goal.reference!r} {goal.subject!r} may be")
        rooms = question.rooms[goal]
        names = question.planned.keys() - {goal.subject, reference}
        others = [(view.sought(name).draw, pose) for name, pose in question.planned.items() if name in names]
        stands = place.found(view.before)  # it may itself stand on another: only the side tells how high
        if stands is None:
            return None
        room = covered_by(rooms, stands.pose, view.camera)
        old = thing.found({"top": view.before["top"]}, view.change.all & ~room)
        if old is None:
            return None
        within = place.draw if goal.relation == "inside" else None
        put = view.stood_up(goal.subject)
        return _Putting(view, put, place, rooms, others, within).measured(stands, room, old)

    def verdict(self, goal: Goal, thing: str, place: str) -> Verdict:
        """Judge whether the object came to be in or on the other."""
        word = "in" if goal.relation == "inside" else "on"
        refusal = self._missing(goal, thing, place, word) or self._doubtful(thing, place, word)
        if refusal is not None:
            return refusal
        sure = 0.5 + 0.5 * min(1.0, self.inside / 0.8)
        return decided(True, f"the {thing} left its place, and {self._placement_in_words(word, place)}", sure)

    def _placement_in_words(self, word: str, place: str) -> str:
        return f"{100 * min(1.0, self.inside):.0f} % of it is seen {word} the {place}"

    def _missing(self, goal: Goal, thing: str, place: str, word: str) -> Verdict | None:
        """A no where the object was not moved, the receptacle was, or the object is elsewhere."""
        if self.left < LEFT_SHARE:
            return refused(f"the {thing} still lies where it was", 1 - self.left, "lost")
        if self.shifted > SETTINGS.shifted_m or self.stirred > SETTINGS.stirred_share:
            return refused(f"the {place} was moved away or tipped over", 0.8, "astray")
        if self.inside < (SETTINGS.inside_share if goal.relation == "inside" else SETTINGS.on_share):
            failure: Failure = "astray" if self.beside >= SETTINGS.beside_share else "lost"
            seen = self._placement_in_words(word, place)
            return refused(f"the {thing} left its place and is not found {word} the {place}: {seen}", 0.8, failure)
        if self.aloft is not None and self.aloft < SUPPORT.aloft_share:
            seen = f"{100 * self.aloft:.0f} % of it is seen there from the side"
            return refused(f"the {thing} does not lie as high as {word} the {place}: {seen}", 0.8, "astray")
        return None

    def _doubtful(self, thing: str, place: str, word: str) -> Verdict | None:
        """A no where the new object is another one, hides all possible supports, or lies across the edge."""
        if self.alike < LOOKS_SHARE or not self.plain:
            return refused(f"what came to be {word} the {place} does not look like the {thing}", 0.7)
        if not self.support_seen:
            return refused(f"whether the {place} is under the {thing}, which hides it, cannot be told from above", 0.5)
        balances = self.margin <= (SETTINGS.well_in_m if self.aloft is None else 0.0)
        if self.share < (SETTINGS.nearly_all_share if balances else SETTINGS.mostly_share):
            across = f"the {thing} lies across the edge of the {place}: {100 * self.share:.0f} % {word} it"
            return refused(across, 0.7, "astray")
        return None


def judge_placed(view: CriticView, goal: Goal) -> Judged:
    """Judge whether an object was put in or on another."""
    evidence, thing, place = Placed.gather(view, goal), view.phrase(goal.subject), view.phrase(str(goal.reference))
    if evidence is None:
        return Judged(refused(f"the {thing} or the {place} is not found before", 0.5), view.nowhere)
    return Judged(evidence.verdict(goal, thing, place), evidence.explained)


@dataclass(frozen=True)
class _Putting:
    """An object that was to be put in or on another.

    Args:
        view: of the question.
        thing, place: the object and the receptacle, parts open as they are.
        rooms: (n, 8, 3) corners of the object's possible places, in the receptacle's frame.
        others: the other planned objects there.
        within: drawing of a receptacle with walls.
    """

    view: CriticView
    thing: Sought
    place: Sought
    rooms: np.ndarray
    others: Sequence[tuple[Draw, Pose]]
    within: Draw | None = None

    def measured(self, stands: Standing, room: np.ndarray, old: Standing) -> Placed:
        """Measure, also where the receptacle was moved a little.

        Args:
            stands: the receptacle before.
            room: (H, W) bool, where the object should be.
            old: the object before.
        """
        before, after, change = self.view.before, self.view.after, self.view.change
        lies, support = None, Support(stands)
        from_side = len(before.keys() & after.keys()) > 1
        if from_side or not stays(self.place, stands, change, before["top"], after["top"]):
            lies = self._lying(stands, before, room)
            support = find_support(self.place, stands, lies, change, before, after)
        now = support.now or stands
        if now is not stands:
            before = {**before, "top": redrawn(before["top"], self.place.background, stands, now)}
            change, room = (
                Change.between(before["top"], after["top"]),
                covered_by(self.rooms, now.pose, self.view.camera),
            )
            lies = self._lying(now, before, room)
        places = Places(old, stands, support, room, change, lies, lambda: self._lying(now, before, room))
        return self._compared(places, before["top"], after["top"])

    def _lying(self, at: Standing, before: Mapping[str, View], room: np.ndarray) -> Lying | None:
        here = grown(room, SETTINGS.edge_px)
        return find_lying(self.thing, self.rooms, at.pose, before, self.view.after, here, self.others, self.within)

    def _compared(self, places: Places, before: View, after: View) -> Placed:
        """Measure what came to be seen in or on a receptacle, and around it, from above."""
        old, now, change, lies = places.old, places.now, places.change, places.lies
        # A black bowl that leaves a black stove changes the picture little.
        faint = changed(smoothed(before.picture), smoothed(after.picture), least=SUPPORT.faint_lab)
        came, alike, stirred = came_to(places, before, after, self.thing)
        if lies is not None and lies.seen and now is not places.stands:  # the rest is of the support, which moved
            came, alike = (mask & grown(lies.standing.covered, SETTINGS.edge_px) for mask in (came, alike))
        here, wide, area = places.here, places.wide, places.area
        seen, size = max(1, int((came & here).sum())), float(np.hypot(*np.ptp(np.argwhere(old.covered), axis=0)))
        hangs_out = reaching(change.things & ~old.covered, here) & grown(here, size / 2)
        near = change.things & about(wide) & ~here & ~about(old.covered)
        inside, like = float((came & here).sum()) / area, float((alike & here).sum()) / min(seen, area)
        doubtful = min(inside, like) < SETTINGS.plain_share
        shift = np.inf if places.support.now is None else float(np.linalg.norm(now.pose.p - places.stands.pose.p))
        return Placed(
            left=self.thing.left(old, change.all | faint, after),
            shifted=shift,
            stirred=float(stirred[places.stands.covered].mean()) if places.stands.covered.any() else 0.0,
            inside=inside,
            share=float((alike & here).sum()) / max(1, int(alike.sum())),
            alike=like,
            beside=float(near.sum()) / area,
            margin=margin_of(alike & here, self.rooms, now.pose, before.camera),
            explained=grown(old.covered, VIEW.around_px) | wide | grown(hangs_out, VIEW.around_px),
            support_seen=places.support.seen or self.place.look.size[2] < THIN_SUPPORT_M,
            plain=not doubtful or (places.drawn is not None and places.drawn.seen),
            aloft=None if lies is None else lies.aloft,
        )


STILL_SHARE = 0.25
"""Share of what came or went since before that may change while an object is weighed."""


def judge_weighed(view: CriticView, goal: Goal) -> Judged:
    """Judge if an object came to lie on a scale, and lay still there."""
    on = next((g for g in view.question.goals if g.subject == goal.subject and g.relation == "on"), None)
    thing = view.phrase(goal.subject)
    if on is None or "top" not in view.moment:
        return unseen(view, f"the {thing} lying on a scale")
    lies, explained = judge_placed(view, on)
    if not lies.accepted:
        return Judged(lies, explained)
    restless = _restless(view)
    seen = f"{100 * restless:.0f} % of the {thing} changed while it was weighed"
    return Judged(decided(restless <= STILL_SHARE, seen, 0.5 + abs(restless - STILL_SHARE)), explained)


def _restless(view: CriticView) -> float:
    """Share of the change since before that came after the moment."""
    before, moment, after = view.before["top"], view.moment["top"], view.after["top"]
    change = changed_between(before, after)
    return float(changed_between(moment, after)[change].mean()) if change.any() else 1.0
