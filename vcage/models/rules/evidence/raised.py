"""Evidence of an object that an arm lifted: drawings of it above its old place, from the side.

Seen from above, an arm hides what it holds, and hides what still lies below it. The customer sees the object before
the arm, and its old place empty below it. The camera on the hand sees if it is between the fingers, or if these touch.
No object is where the table is seen from above; a sure hand may see more of that, for a thing sways in it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vcage.base.geometry import Pose
from vcage.goals.thresholds import THRESHOLDS
from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.drawings import drawn_whole
from vcage.models.rules.evidence.fingers import closed_on_nothing
from vcage.models.rules.evidence.in_hand import InHand, in_hand
from vcage.models.rules.evidence.judgement import Judged, decided, refused, unseen
from vcage.models.rules.evidence.moments import Moment, at_moment
from vcage.models.rules.evidence.moved import Moved
from vcage.models.rules.evidence.vacated import SETTINGS as VACATED
from vcage.models.rules.evidence.vacated import vacated
from vcage.models.rules.pixels import changed_between, share_of
from vcage.models.rules.standing import Sought, Standing
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.vision.protocols import View


@dataclass(frozen=True)
class RaisedSettings:
    """Places in the air that are drawn, and limits for a yes.

    Args:
        highest_m, step_m: heights over the old place, from the least of the goal up.
        alike_lab: colour distance up to which a pixel looks like the object: an arm is before what was there, too.
        seen_share: share of the pixels that tell the object from what was there before that must look like it.
        held_share, doubted_share: the same where the camera on the hand surely sees it between the fingers, and where
            that sees nothing like it.
        elsewhere_share: what is seen so much on its old place, or seen through so much, needs ``seen_share`` even where
            the camera on the hand surely sees it.
        left_share: share of the old outline that must look as without the object.
        stays_share, agreed_stays_share: share of the pixels that tell the object on its old place from a bare table,
            seen from above, from which it may still stand there; and the same where the camera on the hand sees
            something like it, by ``agreed_gain`` and more, and not surely it.
        lies_share, surely_lies_share: share of the pixels that tell the object where it is put down from which it lies
            there already; and the same where the camera on the hand sees something like it: an arm may hide that place.
        apart_m: an object that is put down nearer to its old place is taken to stand there.
        through_share, surely_through_share: share of the pixels that tell it in the air, seen from above, that look
            like the bare table, from which it is not there if a camera is on the hand that does not surely see it; and
            even if that does, where the object does not lean. Without such a camera nothing tells an object that sways
            from one that is gone.
    """

    highest_m: float = 0.4
    step_m: float = 0.01
    alike_lab: float = 14.0
    seen_share: float = 0.5
    held_share: float = 0.3
    doubted_share: float = 0.85
    elsewhere_share: float = 0.5
    left_share: float = 0.3
    stays_share: float = 0.6
    agreed_stays_share: float = 0.2
    agreed_gain: float = 0.1
    lies_share: float = 0.55
    surely_lies_share: float = 0.75
    apart_m: float = 0.03
    through_share: float = 0.6
    surely_through_share: float = 0.85


SETTINGS = RaisedSettings()


@dataclass(frozen=True)
class Raised:
    """Measurements of an object at a moment.

    Args:
        vacated: share of its old outline, where it is not in the air, that looks as it does afterwards, and not as
            before; where that hardly differs, as after it is put back, the share that has changed; None where that is
            little, too.
        stays: share of what tells it on its old place, seen from above, that looks like it; None where that is little.
        lies: the same of where it is put down afterwards, from above or from the customer's side: the larger.
        seen: largest share of what tells it in the air that looks like it.
        height: above its old place of that likeliest drawing, metres.
        through: share of what tells that drawing from a bare table, seen from above, that looks like the table.
        hand: what the camera on the hand sees; None without one.
        closed: True where that camera sees the fingers touching.
        old, new: where it stood and stands; None where it is not found.
    """

    vacated: float | None
    stays: float | None
    lies: float
    seen: float
    height: float
    through: float
    hand: InHand | None
    closed: bool
    old: Standing
    new: Standing | None

    @classmethod
    def gather(
        cls,
        view: CriticView,
        name: str,
        moment: Moment,
        highest_m: float = SETTINGS.highest_m,
        alike_lab: float = SETTINGS.alike_lab,
    ) -> Raised | None:
        """Measure an object above its old place; None where that is not found.

        Args:
            view, name: of the question, and of the object.
            moment: when it is in the air.
            highest_m: up to which it is looked for, metres.
            alike_lab: colour distance up to which a pixel looks like it.
        """
        moved = Moved.of(view, name)
        if moved.old is None:
            return None
        before, side, thing, stood = view.before["customer"], moment.views["customer"], view.sought(name), moved.old

        def raised(height: float) -> Standing:
            return replace(stood, pose=Pose(stood.pose.p + [0.0, 0.0, height], stood.pose.q))

        def seen(height: float) -> float:
            return _share(thing, raised(height), side, before.picture, alike_lab)

        heights = np.arange(THRESHOLDS.lifted_m, highest_m, SETTINGS.step_m)
        share, height = max((seen(height), float(height)) for height in heights)
        held = raised(height)
        was, now = (drawn_whole(thing.draw, there.pose, before.camera).covered for there in (stood, held))
        background, top = view.question.background, moment.views["top"]
        return cls(
            vacated=_left(before, side, view.after["customer"], was & ~now),
            stays=None if background is None else _told(thing, stood, top, background),
            lies=_lies(view, thing, moved, moment, share),
            seen=share,
            height=height,
            through=0.0 if background is None else _through(thing, held, top, background),
            hand=in_hand(view, name, moment.hand),
            closed=closed_on_nothing(view.question, moment.hand),
            old=stood,
            new=moved.new,
        )

    def verdict(self, thing: str, seen_share: float = SETTINGS.seen_share, leans: bool = False) -> Verdict:
        """Judge if the object was in the air.

        Args:
            thing: words for the object.
            seen_share: least share of the pixels that tell it that must look like it, where the hand does not tell.
            leans: True where it is not upright, as it is drawn.
        """
        refusal = self._not_in_the_air(thing, leans)
        if refusal is not None:
            return refusal
        words = f"{100 * self.seen:.0f} % of the {thing} is seen {100 * self.height:.0f} cm above its place"
        least = self._least(seen_share)
        if self.seen >= least and self._held:
            words += ", and the camera on the hand sees it between the fingers"
        return decided(self.seen >= least, words, 0.5 + abs(self.seen - least) / 2, "lost")

    @property
    def _held(self) -> bool:
        """True where the hand surely holds it."""
        return self.hand is not None and self.hand.is_sure

    @property
    def _agreed(self) -> bool:
        """True where the camera on the hand sees something like it."""
        return self.hand is not None and self.hand.agrees

    def _not_in_the_air(self, thing: str, leans: bool) -> Verdict | None:
        """A no because it is seen elsewhere, or not in the hand; None where nothing speaks against it."""
        if self.closed:
            return refused("the fingers have closed on nothing", 0.9, "lost")
        if self.hand is not None and self.hand.contradicts:
            return refused(f"the camera on the hand does not see the {thing} between the fingers", 0.8, "lost")
        if self.vacated is None and not self._is_away:
            return refused(f"nothing shows that the {thing} left its place", 0.6, "lost")
        if self.vacated is not None and self.vacated < SETTINGS.left_share:
            return refused(f"the {thing} stands where it was at the moment of the lift", 1 - self.vacated, "lost")
        return self._seen_through(thing, leans) or self._on_the_table(thing)

    @property
    def _is_away(self) -> bool:
        """True where it is seen from above that its old place is empty, and the hand sees it."""
        if self._held:
            return self.stays is None or self.stays < SETTINGS.stays_share
        if self.hand is None or self.stays is None or self.hand.contradicts:
            return False
        return self.hand.gain >= SETTINGS.agreed_gain and self.stays < SETTINGS.agreed_stays_share

    def _seen_through(self, thing: str, leans: bool) -> Verdict | None:
        """A no because the table is seen where it would be; None where it may be there."""
        if self.hand is None or (self._held and leans):
            return None
        if self.through < (SETTINGS.surely_through_share if self._held else SETTINGS.through_share):
            return None
        return refused(f"the table is seen where the {thing} would be in the air", self.through, "lost")

    def _on_the_table(self, thing: str) -> Verdict | None:
        """A no because it lies where it is put down; None where it may be held."""
        if self._held or self.lies < (SETTINGS.surely_lies_share if self._agreed else SETTINGS.lies_share):
            return None
        return refused(f"the {thing} lies on the table at the moment of the lift", self.lies, "lost")

    def _least(self, seen_share: float) -> float:
        """Least share of the pixels that tell it that must look like it."""
        if self.hand is None:
            return seen_share
        elsewhere = max(self.stays or 0.0, self.through) >= SETTINGS.elsewhere_share
        if self._held and self.vacated is not None and not elsewhere:
            return min(seen_share, SETTINGS.held_share)
        return seen_share if self._held or self._agreed else SETTINGS.doubted_share


def _share(
    thing: Sought, there: Standing, view: View, without: np.ndarray, alike_lab: float = SETTINGS.alike_lab
) -> float:
    """The same as :func:`_told`; 0 where too few tell, as out of the picture."""
    return _told(thing, there, view, without, alike_lab) or 0.0


def _told(
    thing: Sought, there: Standing, view: View, without: np.ndarray, alike_lab: float = SETTINGS.alike_lab
) -> float | None:
    """Share of the pixels that tell an object somewhere that look like it; None where too few tell."""
    share, pixels = thing.speaks(there, view, without, alike_lab=alike_lab)
    return share if pixels >= VACATED.fewest_px else None


def _through(thing: Sought, there: Standing, view: View, without: np.ndarray) -> float:
    """Share of the pixels that tell an object somewhere that look as without it; 0 where too few tell."""
    share, pixels = thing.seen_through(there, view, without, SETTINGS.alike_lab)
    return share if pixels >= VACATED.fewest_px else 0.0


def _left(before: View, moment: View, after: View, where: np.ndarray) -> float | None:
    """How much of an old outline (H, W) bool an object has left: see :class:`Raised`."""
    left = vacated(before, moment, after, where)
    if left is None:
        left = share_of(changed_between(before, moment), where)
        return left if left >= SETTINGS.left_share else None
    return left


def _lies(view: CriticView, thing: Sought, moved: Moved, moment: Moment, seen: float) -> float:
    """Share of what tells an object where it lies afterwards that looks like it at the moment, see :class:`Raised`.

    What is still in the air afterwards is seen before many a place, from above even before the one below it. There,
    the customer alone tells, and only what looks more like it than what is ``seen`` in the air.
    """
    new, old = moved.new, moved.old
    if new is None or old is None or np.linalg.norm(new.pose.p - old.pose.p) < SETTINGS.apart_m:
        return 0.0
    shares = {name: _share(thing, new, moment.views[name], view.before[name].picture) for name in ("customer", "top")}
    if moment.is_end:
        return shares["customer"] if shares["customer"] > seen else 0.0
    return max(shares.values())


def in_the_air(
    view: CriticView,
    goal: Goal,
    moment: Moment | None,
    highest_m: float = SETTINGS.highest_m,
    alike_lab: float = SETTINGS.alike_lab,
) -> Raised | Judged:
    """Measure the subject of a goal in the air; a no where no picture shows it, or it is not found before. Arguments as
    of :meth:`Raised.gather`."""
    thing = view.phrase(goal.subject)
    if moment is None:
        return unseen(view, f"the {thing} in the air from the customer's side")
    found = Raised.gather(view, goal.subject, moment, highest_m, alike_lab)
    return found or Judged(refused(f"the {thing} is not found before", 0.6), view.nowhere)


def judge_lifted(view: CriticView, goal: Goal) -> Judged:
    """Judge if an object was in the air at the moment."""
    found = in_the_air(view, goal, at_moment(view))
    if isinstance(found, Judged):
        return found
    return Judged(found.verdict(view.phrase(goal.subject)), view.around(found.old, found.new))
