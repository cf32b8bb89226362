"""Lifted: one arm held an object in the air for a moment, whatever came of it afterwards."""

from vcage.goals.hands import in_one_hand
from vcage.goals.kind import GoalKind, Shown, State, Stated, cm, too_short
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def _meaning(limits: Thresholds) -> str:
    return f"""
    Lifted: one arm alone held the thing {cm(limits.lifted_m)} or more above the table for {limits.lifted_s:g} s.
    """


def _complaint(goal: Stated, state: State) -> str | None:
    return too_short(goal, state, THRESHOLDS.lifted_s)


LIFTED = GoalKind(
    word="lifted",
    event=True,
    happens=lambda goal, state, notes: in_one_hand(goal, state),
    complaint=_complaint,
    meaning=_meaning,
    evidence="lifted",
    shown=Shown(customer=True, moment=True, in_the_air=True),
    says="lift lifted lifts raise raised",
    claims="lift lifted lifts raise raised",
    plain="{thing} was lifted",
    commands="Lift {0}.|Lift {0} up.|Raise {0}.|Raise {0} above the table.|Please lift {0}.|Could you lift {0}?"
    "|Get {0} lifted.|Have {0} lifted.|Let {0} be lifted.|{1} must be lifted.",
)
