"""Evidence of a pressed button: the hand covers it, seen from above, and it is at the finger tips, seen from the hand.

From above, hand and arm also hide a button beside which the fingers came down. The camera on the hand sees that.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from vcage.base.geometry import Pose
from vcage.models.protocols import HandView
from vcage.models.rules.critic_view import VIEW, CriticView
from vcage.models.rules.drawings import Draw
from vcage.models.rules.evidence.hand_picture import HandPicture
from vcage.models.rules.evidence.judgement import Judged, decided, refused
from vcage.models.rules.evidence.parts import PosedObject
from vcage.models.rules.pixels import changed, grown, share_of
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal, part_words
from vcage.vision.colour import to_lab


@dataclass(frozen=True)
class PressSettings:
    """The comparison of pictures of a press with drawings, and limits for a yes.

    Args:
        away_share: share of its range at which a button is far from its object, on the side to which it springs back.
        depth_m: the button is where a drawing is farther away by more than this when that is gone; its colour may be
            that of the object.
        touched_share: share of a button's visible area that the hand covers while it presses it.
        ring_px: width of the ring around a button that is looked at as well.
        ring_share: changed share of that ring from which a hand covers the button, even one of its colour.
        beside_m, directions: distance and directions from its place at which the thing is drawn as well.
        fewest_px: least number of pixels of the thing in the reduced picture of a camera on a hand, else that does not
            see it.
    """

    away_share: float = -1000.0
    depth_m: float = 0.0005
    touched_share: float = 0.15
    ring_px: float = 4.0
    ring_share: float = 0.6
    beside_m: float = 0.05
    directions: int = 12
    fewest_px: int = 40


SETTINGS = PressSettings()


@dataclass(frozen=True)
class PressEvidence:
    """Measurements of a press, all from pixels.

    Args:
        touched, around: changed shares of the part's visible area, and of a ring around it, in the picture of the
            moment from above; 0 without one.
        beside: how unlike the picture of the camera on the hand the likeliest drawing of the thing beside the tips is,
            in shares of how unlike the likeliest one with its part at them is; inf where nothing is under the hand, or
            no such camera shows the thing.
        covered: (H, W) bool, the area of the object.
    """

    touched: float
    around: float
    beside: float
    covered: np.ndarray

    @classmethod
    def gather(cls, view: CriticView, goal: Goal) -> PressEvidence | None:
        """Measure the part of a goal's subject; None where the subject is not found before.

        Raises:
            InputFileError: there is no picture of the empty table, or nothing draws the object.
        """
        thing, part = PosedObject.found(view, goal), str(goal.part)
        if thing is None:
            return None
        rest, gone = thing.drawings(part, (0.0, SETTINGS.away_share))
        button = np.abs(rest.depth - gone.depth) > SETTINGS.depth_m
        touched, ring = _touched(button if button.any() else rest.covered, view)
        under = touched >= SETTINGS.touched_share or ring >= SETTINGS.ring_share
        return cls(touched, ring, _beside(thing, view, goal) if under else np.inf, rest.covered)

    def verdict(self, goal: Goal, thing: str) -> Verdict:
        """Judge by the hand that covers the part, or all that is around it, and by what its camera sees at the tips."""
        part = f"the {part_words(str(goal.part))} of the {thing}"
        seen, share, least = part, self.touched, SETTINGS.touched_share
        if self.touched < least and self.around >= SETTINGS.ring_share:
            seen, share, least = f"what is around {part}", self.around, SETTINGS.ring_share
        reason = f"{100 * share:.0f} % of {seen} is under the hand at the moment of the press"
        if share >= least and self.beside < 1:
            seen_beside = f"{reason}, but the camera on the hand sees it beside the finger tips"
            return refused(seen_beside, 1 - 0.5 * self.beside)
        return decided(share >= least, reason, 0.5 + 0.5 * abs(share - least))


def judge_pressed(view: CriticView, goal: Goal) -> Judged:
    """Judge whether a button was pressed."""
    evidence = PressEvidence.gather(view, goal)
    phrase = view.question.looks[goal.subject].phrase
    if evidence is None:
        return Judged(refused(f"the {phrase} is not found", 0.5), view.nowhere)
    return Judged(evidence.verdict(goal, phrase), grown(evidence.covered, VIEW.around_px))


# --- from above ------------------------------------------------------------------------------------------------


def _touched(part: np.ndarray, view: CriticView) -> tuple[float, float]:
    """Changed shares of an area (H, W) bool and of a ring around it in the picture of the moment; 0 without one."""
    if "top" not in view.moment:
        return 0.0, 0.0
    change = changed(*(to_lab(one["top"].picture) for one in (view.after, view.moment)))
    return share_of(change, part), share_of(change, grown(part, SETTINGS.ring_px) & ~part)


# --- from the hand ---------------------------------------------------------------------------------------------


def _beside(thing: PosedObject, view: CriticView, goal: Goal) -> float:
    """How unlike a thing beside the finger tips is, relative to one at them: see :class:`PressEvidence`."""
    presses, part, found = view.question.presses, str(goal.part), []
    if presses is None:
        return np.inf
    for name, picture in view.question.uncalibrated.get("moment", {}).items():
        hands = list(presses(goal.subject, thing.pose, part, name))
        if hands:
            draw = thing.draw_at({**thing.rest, part: 1.0})
            found.append(_beside_tips(HandPicture(picture, hands[0].camera), hands, thing.pose, draw))
    return max(found, default=np.inf)  # of two hands, one presses


def _beside_tips(picture: HandPicture, hands: Sequence[HandView], pose: Pose, draw: Draw) -> float:
    """Unlikeness with the thing beside its place, in shares of that with the thing there, each the least; inf where
    the thing cannot be seen.

    Args:
        picture: of a camera on the hand.
        hands: that press it there.
        pose: of the thing.
        draw: draws it, pressed.
    """
    shown = [picture.drawing(hand, pose, draw).covered & ~picture.fingers(hand) for hand in hands]
    if not picture.shows or min(map(np.sum, shown)) < SETTINGS.fewest_px:
        return np.inf

    def least(poses: Iterable[Pose]) -> float:
        tried = product(hands, poses)
        return min(picture.unlike(picture.drawing(hand, at, draw), picture.fingers(hand)) for hand, at in tried)

    return least(_around(pose)) / max(least([pose]), 1e-6)


def _around(pose: Pose) -> Iterable[Pose]:
    """Poses of a thing beside its own, as far as fingers that miss its button come down."""
    for way in np.linspace(0, 2 * np.pi, SETTINGS.directions, endpoint=False):
        yield Pose(pose.p + SETTINGS.beside_m * np.array([np.cos(way), np.sin(way), 0.0]), pose.q)
