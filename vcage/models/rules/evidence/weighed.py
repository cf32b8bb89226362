"""Evidence of an object that lay still on a scale."""

from __future__ import annotations

from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.evidence.placed import judge_placed
from vcage.models.rules.evidence.told import Told, decided, unseen
from vcage.models.rules.pixels import changed_between
from vcage.schema.goals import Goal

STILL_SHARE = 0.25
"""Share of what came or went since before that may change while an object is weighed."""


def judge_weighed(view: CriticView, goal: Goal) -> Told:
    """Judge whether an object came to lie on a scale, and lay there still."""
    on = next((g for g in view.question.goals if g.subject == goal.subject and g.relation == "on"), None)
    thing = view.phrase(goal.subject)
    if on is None or "top" not in view.moment:
        return unseen(view, f"the {thing} lying on a scale")
    lies, explained = judge_placed(view, on)
    if not lies.accepted:
        return Told(lies, explained)
    restless = _restless(view)
    seen = f"{100 * restless:.0f} % of the {thing} changed while it was weighed"
    return Told(decided(restless <= STILL_SHARE, seen, 0.5 + abs(restless - STILL_SHARE)), explained)


def _restless(view: CriticView) -> float:
    """Share of what came or went since before that changed after the moment."""
    before, moment, after = view.before["top"], view.moment["top"], view.after["top"]
    change = changed_between(before, after)
    return float(changed_between(moment, after)[change].mean()) if change.any() else 1.0
