"""Evidence of a scan: an object that is held before a scanner, or a scanner before an object."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.drawings import refined
from vcage.models.rules.evidence.in_use import Found, InUse, shifted
from vcage.models.rules.evidence.judgement import LEFT_SHARE, Judged, decided, refused, surest, unseen
from vcage.models.rules.standing import Standing
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal


@dataclass(frozen=True)
class ScanSettings:
    """Alternatives at which no code is read, and the object may be seen instead; and the limit for a yes.

    Args:
        away_m, directions, headings: distances, directions and headings of the alternatives.
        held_share: share of its drawing that must be found at the moment; the hand hides some.
    """

    away_m: tuple[float, ...] = (0.1, 0.16)
    directions: int = 8
    headings: int = 4
    held_share: float = 0.55


SETTINGS = ScanSettings()


@dataclass(frozen=True)
class Shown:
    """Measurements of a scan.

    Args:
        left: changed share of the moved object's old outline at the moment, in the view with the least change: a hand
            before it hides it from one side.
        seen: share of the evidence for a drawing of it in reading position at the moment.
        elsewhere: the same at the likeliest alternative, too far away or turned so that nothing is read.
    """

    left: float
    seen: float
    elsewhere: float

    @classmethod
    def gather(cls, view: CriticView, moved: str, still: str, held: Standing, stands: Standing) -> Shown:
        """Measure if one object is held before another so that a code is read.

        Args:
            view: of the question.
            moved, still: ids of the two.
            held, stands: where they stood before.
        """
        use = InUse(view, moved, still, held, stands)
        if use.left < LEFT_SHARE or view.question.readings is None:
            return cls(use.left, 0.0, 0.0)
        found = [(use.unseen(pose), pose) for pose in view.question.readings(moved, held.pose, still, stands.pose)]
        least, pose = min(found, key=lambda one: one[0], default=(1.0, held.pose))
        nearby, _ = refined(np.zeros(3), least, lambda shift: use.unseen(shifted(pose, shift)))
        turned = [shifted(pose, [0.0, 0.0, turn]) for turn in _TURNS[1:]]
        others = [*turned, *(shifted(pose, [*away, turn]) for away in _AWAY for turn in _TURNS)]
        return cls(use.left, 1 - nearby, 1 - min(map(use.unseen, others)))

    def verdict(self, moved: str, still: str) -> Verdict:
        """Judge if one object was held before the other so that a code was read."""
        if self.left < LEFT_SHARE:
            return refused(f"the {moved} lies where it was at the moment of the scan", 1 - self.left, "lost")
        seen = f"{100 * self.seen:.0f} % of the {moved} is seen before the {still} at the moment of the scan"
        accepted, sure = self.seen >= max(SETTINGS.held_share, self.elsewhere), abs(self.seen - SETTINGS.held_share)
        return decided(accepted, f"{seen}, {100 * self.elsewhere:.0f} % farther away", 0.5 + sure)


def judge_scanned(view: CriticView, goal: Goal) -> Judged:
    """Judge whether a scanner was held before the object, or the object before a scanner."""
    question = view.question
    if question.readings is None or "top" not in view.moment:
        return unseen(view, f"the moment at which the {view.phrase(goal.subject)} is read")
    moved = question.grasped or goal.subject
    others = [goal.subject] if moved in question.readers else question.readers
    judged = [_judged(view, moved, still) for still in others]
    return surest(judged, Judged(refused("there is no scanner", 1.0), view.nowhere))


def _judged(view: CriticView, moved: str, still: str) -> Judged:
    found = Found.of(view, moved, still)
    if isinstance(found, Judged):
        return found
    shown = Shown.gather(view, moved, still, found.held, found.stands)
    verdict = shown.verdict(found.moved.look.phrase, found.still.look.phrase)
    return Judged(verdict, found.explained)


_TURNS = np.linspace(0, 2 * np.pi, SETTINGS.headings, endpoint=False)
_AWAY = [
    (far * np.cos(angle), far * np.sin(angle))
    for far in SETTINGS.away_m
    for angle in np.linspace(0, 2 * np.pi, SETTINGS.directions, endpoint=False)
]
