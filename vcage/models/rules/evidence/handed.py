"""Evidence of an object that two hands hold in the air at the moment of a hand-over."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.evidence.judgement import LEFT_SHARE, Judged, decided, refused, unseen
from vcage.models.rules.evidence.moved import Moved
from vcage.models.rules.pixels import Change, changed_between, share_of
from vcage.models.rules.standing import Standing
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.vision.protocols import View


@dataclass(frozen=True)
class ReachSettings:
    """Signs of arms that reach out, seen from above.

    Args:
        edge_share: depth of the strip on the robot's side of the picture, as a share of its height.
        enters_share: share of that depth, at the edge, in which an arm enters the strip.
        reaches_share: share of one half of that strip that an arm changes which enters there: the other may cross it.
            Of the 14 pictures of one arm or two that were measured: 11 % and more on aloha_agilex, where grey arms are
            narrow, 10 % and more on dual_panda; 0 % on the side of an arm that stays at home.
    """

    edge_share: float = 0.35
    enters_share: float = 0.36
    reaches_share: float = 0.09


REACH = ReachSettings()


def arms_out(before: View, now: View) -> tuple[float, float]:
    """Share of the strip on the robot's side that an arm changed, in its left and right half, seen from above."""
    change = Change.between(before, now)
    arms = change.things | change.lighter  # an arm's shadow falls on the other one's side
    depth = round(len(arms) * REACH.edge_share)
    _, labels = cv2.connectedComponents(arms[-depth:].astype(np.uint8))
    halves = np.array_split(labels, 2, axis=1)
    entered = (np.setdiff1d(half[-round(depth * REACH.enters_share) :], 0) for half in halves)
    left, right = (float(np.isin(half, own).mean()) for half, own in zip(halves, entered, strict=True))
    return left, right


@dataclass(frozen=True)
class Between:
    """Measurements of an object between two arms.

    Args:
        left: share of the object's outline before that has changed at the moment.
        to_come: share of its outline afterwards that looks otherwise at the moment.
        arms: share of the strip on the robot's side that changed since before, in its left and right half.
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
        before, moment, after = view.before["top"], view.moment["top"], view.after["top"]
        return cls(
            left=share_of(changed_between(before, moment), moved.old.covered),
            to_come=share_of(changed_between(after, moment), moved.new.covered),
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
    if "top" not in view.moment:
        return unseen(view, f"the moment of the hand-over of the {thing}")
    evidence = Between.gather(view, goal.subject)
    if evidence is None:
        return Judged(refused(f"the {thing} is not found before and after", 0.6), view.nowhere)
    return Judged(evidence.verdict(thing), view.around(evidence.old, evidence.new))
