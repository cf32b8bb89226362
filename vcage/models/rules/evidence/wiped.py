"""Evidence of wiping: a tool on an object where that begins and, later, far from there; the object where it stood."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from vcage.base.geometry import Pose
from vcage.goals.thresholds import THRESHOLDS
from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.evidence.in_use import Found, InUse, least_unseen, shifted
from vcage.models.rules.evidence.judgement import LEFT_SHARE, Judged, decided, refused, surest, unseen
from vcage.models.rules.standing import Standing
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal


@dataclass(frozen=True)
class WipedSettings:
    """Alternatives at which nothing is wiped there, and the tool may be seen instead.

    Args:
        beside_m, directions: distances and directions of the tool beside where it should be.
        over_m: heights of the tool over the object.
        held_share: share of its drawing that must be found at either moment: the hand hides much of a sponge.
    """

    beside_m: tuple[float, ...] = (0.045, 0.08)
    directions: int = 8
    over_m: tuple[float, ...] = (0.04, 0.08)
    held_share: float = 0.3


SETTINGS = WipedSettings()


@dataclass(frozen=True)
class Laid:
    """Measurements of a tool at one of the two moments.

    Args:
        left: changed share of the tool's old outline.
        seen: share of the evidence for a drawing of the tool on the object, where it should be then.
        elsewhere: the same at the likeliest alternative beside that place, or over it.
    """

    left: float
    seen: float
    elsewhere: float

    @classmethod
    def gather(cls, use: InUse, pose: Pose, others: Sequence[Pose]) -> Laid:
        """Measure a tool at a pose.

        Args:
            use: the views of the moment.
            pose: where it should be.
            others: where it should not be.
        """
        directions = np.linspace(0, 2 * np.pi, SETTINGS.directions, endpoint=False)
        there, _ = least_unseen(use, [pose])
        beside = [
            shifted(pose, [far * np.cos(way), far * np.sin(way), 0.0])
            for far, way in product(SETTINGS.beside_m, directions)
        ]
        over = [Pose(pose.p + [0.0, 0.0, up], pose.q) for up in SETTINGS.over_m]
        elsewhere = min(least_unseen(use, some)[0] for some in (beside, over, *([others] if others else [])))
        return cls(use.left, 1 - there, 1 - elsewhere)

    @property
    def shown(self) -> bool:
        """True where the tool is seen to be on the object, where it should be."""
        return self.left >= LEFT_SHARE and self.seen >= max(SETTINGS.held_share, self.elsewhere)


@dataclass(frozen=True)
class Wiped:
    """Measurements of wiping.

    Args:
        begins, farther: of the tool where wiping begins, and later where a stroke ends.
    """

    begins: Laid
    farther: Laid

    @classmethod
    def gather(cls, view: CriticView, tool: str, thing: str, held: Standing, stands: Standing) -> Wiped | None:
        """Measure if a tool wipes an object; None where it does not fit there.

        Args:
            view: of the question.
            tool, thing: ids of the two.
            held, stands: where they stood before.
        """
        question = view.question
        ways = [] if question.wipings is None else [*question.wipings(tool, held.pose, thing, stands.pose)]
        if not ways:
            return None
        first, second = (
            InUse(view, tool, thing, held, stands, at=at, as_before=True) for at in (view.moment, view.later)
        )
        start, end = min(ways, key=lambda way: first.unseen(way[0]) + second.unseen(way[1]))
        return cls(Laid.gather(first, start, [end]), Laid.gather(second, end, [start]))

    def verdict(self, tool: str, thing: str) -> Verdict:
        """Judge if the tool was drawn over the object."""
        for laid, when in ((self.begins, "at the beginning of the wiping"), (self.farther, "later")):
            if laid.left < LEFT_SHARE:
                return refused(f"the {tool} lies where it was {when}", 1 - laid.left, "lost")
        both = (self.begins, self.farther)
        first, later = (f"{100 * one.seen:.0f} % ({100 * one.elsewhere:.0f} % elsewhere)" for one in both)
        seen = f"of the {tool}, {first} is seen on the {thing} at first, and {later} farther on later"
        sure = min(one.seen for one in both) - SETTINGS.held_share
        return decided(self.begins.shown and self.farther.shown, seen, 0.5 + abs(sure), "astray")


def judge_wiped(view: CriticView, goal: Goal) -> Judged:
    """Judge whether a tool was on an object at two places, one after the other, and the object stayed where it was."""
    question = view.question
    if question.wipings is None or "top" not in view.moment or "top" not in view.later:
        return unseen(view, f"the moments at which the {view.phrase(goal.subject)} is wiped")
    tools = [name for name in question.wipers if question.grasped in (None, name) and name != goal.subject]
    judged = [_judged(view, tool, goal.subject) for tool in tools]
    return surest(judged, Judged(refused("there is no tool to wipe with", 1.0), view.nowhere))


def _judged(view: CriticView, tool: str, thing: str) -> Judged:
    found = Found.of(view, tool, thing)
    if isinstance(found, Judged):
        return found
    if disturbed := found.disturbed(view, THRESHOLDS.wiped_moved_m):
        return disturbed
    wiped = Wiped.gather(view, tool, thing, found.held, found.stands)
    called, on = found.moved.look.phrase, found.still.look.phrase
    verdict = refused(f"the {called} does not fit on the {on}", 1.0) if wiped is None else wiped.verdict(called, on)
    return Judged(verdict, found.explained)
