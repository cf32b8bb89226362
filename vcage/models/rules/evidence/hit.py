"""Evidence of a hit: a tool whose head is on the middle of an object at the moment, and the object where it stood."""

from __future__ import annotations

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
class HitSettings:
    """Alternatives at which nothing is hit, and the tool may be seen instead.

    Args:
        beside_m, directions: distances and directions of the head beside the middle of the object.
        over_m: heights of the head over the object.
        held_share: share of its drawing that must be found at the moment: hand and arm hide more of a tool that is held
            at its middle than of a scanner, up to 57 % of a hammer.
        margin_share: by how much more of it must be seen on the object than beside or over it: where another thing was
            hit, little of it is seen in any of these places.
    """

    beside_m: tuple[float, ...] = (0.055, 0.09)
    directions: int = 6
    over_m: tuple[float, ...] = (0.05, 0.09)
    held_share: float = 0.4
    margin_share: float = 0.05


SETTINGS = HitSettings()


@dataclass(frozen=True)
class Struck:
    """Measurements of a hit.

    Args:
        left: changed share of the tool's old outline at the moment.
        seen: share of the evidence for a drawing of the tool with its head on the object.
        beside, over: the same at the likeliest alternative beside it, and over it.
    """

    left: float
    seen: float
    beside: float
    over: float

    @classmethod
    def gather(cls, view: CriticView, tool: str, thing: str, held: Standing, stands: Standing) -> Struck:
        """Measure if a tool hits an object at the moment.

        Args:
            view: of the question.
            tool, thing: ids of the two.
            held, stands: where they stood before.
        """
        use = InUse(view, tool, thing, held, stands)
        if use.left < LEFT_SHARE or view.question.strikes is None:
            return cls(use.left, 0.0, 0.0, 0.0)
        on = [*view.question.strikes(tool, held.pose, thing, stands.pose)]
        # Of a tool beside it, a drawing on it at another heading may be seen best: each heading has alternatives.
        directions = np.linspace(0, 2 * np.pi, SETTINGS.directions, endpoint=False)
        beside = [
            shifted(pose, [far * np.cos(way), far * np.sin(way), 0.0])
            for pose, far, way in product(on, SETTINGS.beside_m, directions)
        ]
        (hits, likeliest), (misses, _) = least_unseen(use, on), least_unseen(use, beside)
        over, _ = least_unseen(use, [Pose(likeliest.p + [0.0, 0.0, up], likeliest.q) for up in SETTINGS.over_m])
        return cls(use.left, 1 - hits, 1 - misses, 1 - over)

    def verdict(self, tool: str, thing: str) -> Verdict:
        """Judge if the tool was on the object."""
        if self.left < LEFT_SHARE:
            return refused(f"the {tool} lies where it was at the moment of the hit", 1 - self.left, "lost")
        accepted = self.seen >= max(SETTINGS.held_share, max(self.beside, self.over) + SETTINGS.margin_share)
        seen = f"{100 * self.seen:.0f} % of the {tool} is seen with its head on the {thing}"
        others = f"{100 * self.beside:.0f} % as drawn beside it and {100 * self.over:.0f} % over it"
        return decided(accepted, f"{seen}, {others}", 0.5 + abs(self.seen - SETTINGS.held_share), "astray")


def judge_hit(view: CriticView, goal: Goal) -> Judged:
    """Judge whether the head of a tool was on an object, which stayed where it was."""
    question = view.question
    if question.strikes is None or "top" not in view.moment:
        return unseen(view, f"the moment at which the {view.phrase(goal.subject)} is hit")
    tools = [name for name in question.hitters if question.grasped in (None, name) and name != goal.subject]
    judged = [_judged(view, tool, goal.subject) for tool in tools]
    return surest(judged, Judged(refused("there is no tool to hit with", 1.0), view.nowhere))


def _judged(view: CriticView, tool: str, thing: str) -> Judged:
    found = Found.of(view, tool, thing)
    if isinstance(found, Judged):
        return found
    if disturbed := found.disturbed(view, THRESHOLDS.hit_moved_m):
        return disturbed
    struck = Struck.gather(view, tool, thing, found.held, found.stands)
    verdict = struck.verdict(found.moved.look.phrase, found.still.look.phrase)
    return Judged(verdict, found.explained)
