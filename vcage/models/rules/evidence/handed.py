"""Evidence of an object that two hands hold in the air at the moment of a hand-over."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.drawings import drawn_whole
from vcage.models.rules.evidence.judgement import LEFT_SHARE, Judged, decided, refused, unseen
from vcage.models.rules.evidence.moved import Moved
from vcage.models.rules.evidence.vacated import vacated
from vcage.models.rules.pixels import Change, changed_between, share_of
from vcage.models.rules.standing import Standing
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.vision.protocols import View


@dataclass(frozen=True)
class ReachSettings:
    """Signs of arms that reach out, seen from the customer's side.

    From above, arms that meet near their bases are hardly seen, and one that draws near another's base looks like it.

    Args:
        height_share: height of the upper part of the picture, in which the arms are, as a share of all.
        side_share: width of that part at either side, as a share of all, in which an arm is seen at home: hands meet
            between the two sides.
        reaches_share: share of one side that changes when its arm leaves home. Of the 28 pictures of two arms that were
            measured: 3 % and more of both sides; of 56 of one arm: 0 % on the side of the other, which is at home.
    """

    height_share: float = 0.5
    side_share: float = 1 / 3
    reaches_share: float = 0.015


REACH = ReachSettings()


def arms_out(before: View, now: View) -> tuple[float, float]:
    """Share that changed at the robot's left and right side; from the customer's side its left is at the right edge."""
    change = Change.between(before, now)
    arms = change.things | change.lighter  # an arm's shadow falls on the other one's side
    height, width = np.array(arms.shape) * [REACH.height_share, REACH.side_share]
    upper = arms[: round(height)]
    return float(upper[:, -round(width) :].mean()), float(upper[:, : round(width)].mean())


@dataclass(frozen=True)
class Between:
    """Measurements of an object between two arms.

    Args:
        left: share of the object's outline before that has changed at the moment, from above or from the customer's
            side: the lesser.
        to_come: share of its outline afterwards that looks otherwise at the moment, in the same way.
        arms: share of the robot's left and right side that changed since before, from the customer's side.
        old, new: where it stood and stands.
    """

    left: float
    to_come: float
    arms: tuple[float, float]
    old: Standing
    new: Standing

    @classmethod
    def gather(cls, view: CriticView, name: str) -> Between | None:
        """Measure an object that is in neither place while arms reach out; None where it is not found.

        Args:
            view, name: of the question, and of the object.
        """
        moved = Moved.of(view, name)
        if moved.old is None or moved.new is None:
            return None
        left, to_come = (
            share_of(changed_between(shown["top"], view.moment["top"]), standing.covered)
            for shown, standing in ((view.before, moved.old), (view.after, moved.new))
        )
        # From above, an arm may hide the place: the customer sees below it.
        before, moment, after = (shown["customer"] for shown in (view.before, view.moment, view.after))
        draw = view.sought(name).draw
        was, will_be = (drawn_whole(draw, standing.pose, before.camera).covered for standing in (moved.old, moved.new))
        left_seen = vacated(before, moment, after, was & ~will_be)
        to_come_seen = vacated(after, moment, before, will_be & ~was)
        return cls(
            left=min(left, 1.0 if left_seen is None else left_seen),
            to_come=min(to_come, 1.0 if to_come_seen is None else to_come_seen),
            arms=arms_out(before, moment),
            old=moved.old,
            new=moved.new,
        )

    def verdict(self, thing: str) -> Verdict:
        """Judge if it was in the air, with both arms out, at the moment."""
        if self.left < LEFT_SHARE:
            return refused(f"the {thing} lies where it was at the moment of the hand-over", 1 - self.left, "lost")
        if self.to_come < LEFT_SHARE:
            return refused(f"the {thing} was put down before the moment of the hand-over", 1 - self.to_come)
        changed = " and ".join(f"{100 * share:.0f} %" for share in self.arms)
        if min(self.arms) < REACH.reaches_share:
            return refused(f"not both arms reach out at the hand-over: {changed} of their sides changed", 0.8)
        return decided(
            True, f"the {thing} is in the air while both arms reach out: {changed} of their sides changed", 0.7
        )


def judge_handed(view: CriticView, goal: Goal) -> Judged:
    """Judge if an object was in two hands at the moment."""
    thing = view.phrase(goal.subject)
    if not {"top", "customer"} <= view.moment.keys() & view.before.keys() & view.after.keys():
        return unseen(view, f"the moment of the hand-over of the {thing}")
    evidence = Between.gather(view, goal.subject)
    if evidence is None:
        return Judged(refused(f"the {thing} is not found before and after", 0.6), view.nowhere)
    return Judged(evidence.verdict(thing), view.around(evidence.old, evidence.new))
