"""Evidence of an object that was put back where it stood at the start."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.evidence.told import LEFT_SHARE, Told, decided, refused, unseen
from vcage.models.rules.pixels import changed_between
from vcage.models.rules.standing import Standing
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal


@dataclass(frozen=True)
class ReturnedSettings:
    """Limits for a yes.

    Args:
        same_share: share of its outline at the start that must look so again.
        near_m: an object that is seen no farther from where it stood is back, though its label may be turned away.
    """

    same_share: float = 0.6
    near_m: float = 0.02


SETTINGS = ReturnedSettings()


@dataclass(frozen=True)
class Returned:
    """Measurements of an object that was put back.

    Args:
        came: share of its outline at the start that changed when it was put there.
        same: share of it that looks as at the start.
        off: how far it is seen from there, metres; inf where it is not found.
        stood, was: where it stood at the start, and before it was put back.
    """

    came: float
    same: float
    off: float
    stood: Standing
    was: Standing | None

    @classmethod
    def gather(cls, view: CriticView, name: str) -> Returned | None:
        """Measure whether an object is again where it stood; None where it is not found at the start."""
        thing, start, before, after = view.sought(name), view.start["top"], view.before["top"], view.after["top"]
        stood = thing.standing(view.start, changed_between(start, before))
        if stood is None or not stood.covered.any():
            return None
        change = changed_between(before, after)
        came, differs = change[stood.covered].mean(), changed_between(start, after)[stood.covered].mean()
        now = thing.standing(view.after, change)
        off = np.inf if now is None else float(np.linalg.norm(now.pose.p - stood.pose.p))
        was = thing.standing(view.before, change & ~stood.covered)
        return cls(float(came), float(1 - differs), off, stood, was)

    def verdict(self, thing: str) -> Verdict:
        """Judge whether it is again where it stood."""
        if self.came < LEFT_SHARE:
            return refused(f"nothing came back to where the {thing} stood", 1 - self.came, "lost")
        seen = f"{100 * self.same:.0f} % of where the {thing} stood looks as at the start"
        if self.off <= SETTINGS.near_m:
            return decided(True, f"the {thing} is seen {100 * self.off:.0f} cm from where it stood, and {seen}", 0.8)
        return decided(self.same >= SETTINGS.same_share, seen, 0.5 + abs(self.same - SETTINGS.same_share))


def judge_returned(view: CriticView, goal: Goal) -> Told:
    """Judge whether an object was put back."""
    thing = view.phrase(goal.subject)
    if "top" not in view.start:
        return unseen(view, f"where the {thing} stood at the start")
    evidence = Returned.gather(view, goal.subject)
    if evidence is None:
        return Told(refused(f"where the {thing} stood at the start is not found", 0.6), view.nowhere)
    return Told(evidence.verdict(thing), view.around(evidence.stood, evidence.was))
