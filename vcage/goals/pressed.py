"""Pressed: a button was pushed in; it may have sprung back since."""

from __future__ import annotations

from vcage.goals.kind import GoalKind, Shown, State, Stated, percent
from vcage.goals.parts import LISTED, part_words
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def _meaning(limits: Thresholds) -> str:
    way = percent(limits.opened_share)
    return f"Pressed: at some time the part was pushed in by {way} or more of its way. It may spring back."


def _complaint(goal: Stated, state: State) -> str | None:
    share = state.furthest_share(goal.subject, str(goal.part))
    if share >= THRESHOLDS.opened_share:
        return None
    return f"the {part_words(str(goal.part))} of {goal.subject} was pressed by {100 * share:.0f} % only"


PRESSED = GoalKind(
    word="pressed",
    complaint=_complaint,
    evidence="pressed",
    meaning=_meaning,
    says="press pressed push hit",
    claims="press pressed",
    listed=LISTED,
    plain="{thing} was pressed",
    commands="Press {0}.|Push {0}.|Push down {0}.|Press {0} down.|Press down on {0}.|Please press {0}."
    "|Give {0} a press.|Could you press {0}?|Hit {0}.|Have {0} pressed.",
    part_of="subject",
    acts_on="press",
    event=True,
    shown=Shown(moment=True),
)
