"""Held by both: at the end both arms hold an object in the air together, and level."""

from __future__ import annotations

from vcage.base.geometry import tilt_between
from vcage.goals.hands import in_hands
from vcage.goals.kind import GoalKind, Shown, State, Stated, cm, degrees
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def _meaning(limits: Thresholds) -> str:
    return f"""
    Held by both: in `after` both arms hold the thing, {cm(limits.lifted_m)} or more above the table, and it leans by
    {degrees(limits.upright_rad)} at most.
    """


def _complaint(goal: Stated, state: State) -> str | None:
    arms = sorted(in_hands(goal, state))
    if len(arms) < 2:
        height = 100 * (state.thing(goal.subject).lowest - state.table_height)
        return f"{goal.subject} is {height:.0f} cm above the table, held by {' and '.join(arms) or 'no arm'} alone"
    lean = tilt_between(state.at_start(goal.subject).pose, state.thing(goal.subject).pose)
    return f"{goal.subject} leans by {degrees(lean)}" if lean > THRESHOLDS.upright_rad else None


HELD_BY_BOTH = GoalKind(
    word="held_by_both",
    complaint=_complaint,
    meaning=_meaning,
    evidence="held_by_both",
    shown=Shown(customer=True, moment=True, in_the_air=True),
    says="both two",
    may_say="lift lifted lifts raise raised hold held holding up",
    gloss=" (at the end, by both arms together)",
    plain="{thing} is held up by both arms",
    commands="Lift {0} with both arms.|Use both arms to lift {0}.|Hold up {0} with both arms.|Lift {0} with both hands."
    "|Use both arms to grab {0}.|Pick up {0} with both arms and hold it.|Please lift {0} with both arms."
    "|Could you lift {0} with both arms?|Raise {0} with both hands.|Take {0} with both arms and hold it up."
    "|{1} must be held up by both arms.",
    fleeting=True,
    arms=2,
)
