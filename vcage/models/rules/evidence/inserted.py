"""Evidence of a thing that was inserted in a hole: drawings of it more and less deep in that, and beside it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from vcage.base.geometry import Pose
from vcage.goals.thresholds import THRESHOLDS
from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.evidence.in_use import Found, InUse, least_unseen
from vcage.models.rules.evidence.judgement import LEFT_SHARE, Judged, decided, refused, unseen
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal


@dataclass(frozen=True)
class InsertedSettings:
    """Alternatives at which nothing is inserted, and limits for a yes.

    Args:
        around_m, directions: distances from the middle of what has the hole, and directions, in which the thing may lie
            on the table.
        headings: of it there and on the top.
        seen_share: share of the evidence for a drawing of the thing in the hole.
        less_share: drawings within this share of the best count as equal. The shallowest of them is taken: a deeper
            one shows less of the thing, so it matches just as well.
    """

    around_m: tuple[float, ...] = (0.05, 0.1, 0.15)
    directions: int = 8
    headings: int = 6
    seen_share: float = 0.6
    less_share: float = 0.06


SETTINGS = InsertedSettings()


@dataclass(frozen=True)
class InTheHole:
    """Measurements of a thing afterwards.

    Args:
        left: changed share of its old outline, seen from above.
        seen: share of the evidence for a drawing of the thing in line with the hole.
        elsewhere: the same at the likeliest place beside or on what has the hole.
        share: of the length of the hole that the thing is seen to fill.
        pose: at which it is seen in line with the hole.
    """

    left: float
    seen: float
    elsewhere: float
    share: float
    pose: Pose

    @classmethod
    def gather(cls, view: CriticView, goal: Goal, found: Found) -> InTheHole | None:
        """Measure how well a thing is seen in a hole; None where it does not fit into one.

        Args:
            view, goal: of the question.
            found: the two, as they stood before.
        """
        place, ask = str(goal.reference), view.question.insertions
        ways = [] if ask is None else [*ask(goal.subject, found.held.pose, place, found.stands.pose)]
        if not ways:
            return None
        use = InUse(view, goal.subject, place, found.held, found.stands, at=view.after, as_before=True)
        seen = [(1 - use.unseen(pose), share, pose) for share, pose in ways]
        best = max(likely for likely, *_ in seen)
        likely, share, pose = min((one for one in seen if one[0] >= best - SETTINGS.less_share), key=lambda one: one[1])
        now = found.moved.found(view.after)
        others = [*_beside(found), *([] if now is None else [now.pose])]
        elsewhere, _ = least_unseen(use, others)
        left = found.moved.left(found.held, view.change.all, view.after["top"])
        return cls(left, likely, 1 - elsewhere, share, pose)

    def verdict(self, thing: str, place: str) -> Verdict:
        """Judge if the thing was inserted in the place."""
        if self.left < LEFT_SHARE:
            return refused(f"the {thing} lies where it was", 1 - self.left, "lost")
        seen = f"{100 * self.seen:.0f} % of the {thing} is seen in line with the hole of the {place}"
        words = f"{seen}, {100 * self.elsewhere:.0f} % as drawn beside it"
        least = max(SETTINGS.seen_share, self.elsewhere)
        if self.seen < least:
            return refused(words, 0.5 + least - self.seen, "astray")
        words = f"{words}; it fills {100 * self.share:.0f} % of the hole"
        sure = 0.5 + min(self.seen - least, abs(self.share - THRESHOLDS.inserted_share))
        return decided(self.share >= THRESHOLDS.inserted_share, words, sure, "astray")


def _beside(found: Found) -> Iterator[Pose]:
    """Poses of the thing as it lay, on the table beside what has the hole and on its top."""
    ways = np.linspace(0, 2 * np.pi, SETTINGS.directions, endpoint=False)
    headings = np.linspace(0, np.pi, SETTINGS.headings, endpoint=False)
    around = [(far * np.cos(way), far * np.sin(way), 0.0) for far, way in product(SETTINGS.around_m, ways.tolist())]
    for shift, heading in product([(0.0, 0.0, found.stands.size[2]), *around], headings.tolist()):
        yield Pose.from_yaw(found.stands.pose.p + shift, heading)


def judge_inserted(view: CriticView, goal: Goal) -> Judged:
    """Judge whether a thing came to lie in a hole of another one, which stands where it stood."""
    if "customer" not in view.after or "customer" not in view.before:
        return unseen(view, f"the {view.phrase(goal.subject)} from the customer's side")
    found = Found.of(view, goal.subject, str(goal.reference))
    if isinstance(found, Judged):
        return found
    lies, thing, place = InTheHole.gather(view, goal, found), found.moved.look.phrase, found.still.look.phrase
    if lies is None:
        return Judged(refused(f"the {thing} does not go into a hole of the {place}", 1.0), found.explained)
    return found.judged(view, lies.verdict(thing, place), lies.pose)
