"""Evidence of a thing that hangs on a rack: drawings of it as it would hang, beside others where it would not."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from vcage.base.geometry import Pose
from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.evidence.in_use import Found, InUse, least_unseen
from vcage.models.rules.evidence.judgement import LEFT_SHARE, Judged, decided, refused, unseen
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal


@dataclass(frozen=True)
class HungSettings:
    """Alternatives at which nothing hangs, and limits for a yes.

    Args:
        around_m, directions, headings: distances from the middle of the rack and directions in which the thing may
            stand or lie on the table beside it, and its headings there.
        lifted_m: height over its place on the peg of a thing that a hand still holds.
        seen_share: share of the evidence for a drawing of the thing on a peg.
    """

    around_m: tuple[float, ...] = (0.05, 0.1, 0.15)
    directions: int = 8
    headings: int = 4
    lifted_m: tuple[float, ...] = (0.04, 0.08)
    seen_share: float = 0.65


SETTINGS = HungSettings()


@dataclass(frozen=True)
class Hung:
    """Measurements of a thing afterwards.

    Args:
        left: changed share of its old outline, seen from above: from the side a thing that hangs may hide it.
        seen: share of the evidence for a drawing of the thing on a peg.
        elsewhere: the same at the likeliest alternative.
        pose: at which it is seen best on a peg.
    """

    left: float
    seen: float
    elsewhere: float
    pose: Pose

    @classmethod
    def gather(cls, view: CriticView, goal: Goal, found: Found) -> Hung | None:
        """Measure how well a thing is seen to hang on a rack; None where it does not fit on a peg.

        Args:
            view, goal: of the question.
            found: the two, as they stood before.
        """
        rack, hangings = str(goal.reference), view.question.hangings
        poses = [] if hangings is None else [*hangings(goal.subject, found.held.pose, rack, found.stands.pose)]
        if not poses:
            return None
        use = InUse(view, goal.subject, rack, found.held, found.stands, at=view.after, as_before=True)
        hangs, likeliest = least_unseen(use, poses)
        others = [*_beside(found), *(Pose(likeliest.p + [0, 0, up], found.held.pose.q) for up in SETTINGS.lifted_m)]
        elsewhere, _ = least_unseen(use, others)
        left = found.moved.left(found.held, view.change.all, view.after["top"])
        return cls(left, 1 - hangs, 1 - elsewhere, likeliest)

    def verdict(self, thing: str, rack: str) -> Verdict:
        """Judge if the thing hangs on the rack."""
        if self.left < LEFT_SHARE:
            return refused(f"the {thing} stands where it was", 1 - self.left, "lost")
        seen = f"{100 * self.seen:.0f} % of the {thing} is seen hanging on the {rack}"
        words = f"{seen}, {100 * self.elsewhere:.0f} % as drawn beside it"
        least = max(SETTINGS.seen_share, self.elsewhere)
        return decided(self.seen >= least, words, 0.5 + abs(self.seen - least), "astray")


def _beside(found: Found) -> Iterator[Pose]:
    """Poses of the thing on the table beside the rack, standing and lying."""
    x, y, z = found.stands.pose.p
    height = found.held.size[2]
    lies = Pose([0.0, height / 2, found.held.size[1] / 2], [np.cos(np.pi / 4), np.sin(np.pi / 4), 0.0, 0.0])
    ways = np.linspace(0, 2 * np.pi, SETTINGS.directions, endpoint=False)
    headings = np.linspace(0, 2 * np.pi, SETTINGS.headings, endpoint=False)
    for far, way, heading in product(SETTINGS.around_m, ways.tolist(), headings.tolist()):
        stands = Pose.from_yaw([x + far * np.cos(way), y + far * np.sin(way), z], heading)
        yield from (stands, stands * lies)


def judge_hung(view: CriticView, goal: Goal) -> Judged:
    """Judge whether a thing came to hang on a rack, which stands where it stood."""
    if "customer" not in view.after or "customer" not in view.before:
        return unseen(view, f"the {view.phrase(goal.subject)} from the customer's side")
    found = Found.of(view, goal.subject, str(goal.reference))
    if isinstance(found, Judged):
        return found
    hung, thing, rack = Hung.gather(view, goal, found), found.moved.look.phrase, found.still.look.phrase
    if hung is None:
        return Judged(refused(f"the {thing} does not fit on a peg of the {rack}", 1.0), found.explained)
    return found.judged(view, hung.verdict(thing, rack), hung.pose)
