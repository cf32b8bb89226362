"""Held up: at the end one arm still holds an object in the air. An arm that held it for a moment has ``lifted`` it."""

from __future__ import annotations

from vcage.goals.hands import in_one_hand
from vcage.goals.kind import GoalKind, Shown, State, Stated, cm
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def _meaning(limits: Thresholds) -> str:
    return f"""
    Held up: in `after` one arm alone holds the thing, {cm(limits.lifted_m)} or more above the table.
    """


def _complaint(goal: Stated, state: State) -> str | None:
    if in_one_hand(goal, state):
        return None
    height = state.thing(goal.subject).lowest - state.table_height
    arms = sorted(state.touching(goal.subject) & {*state.arms})
    held = f"held by {' and '.join(arms) or 'no arm'}, {100 * height:.0f} cm above the table"
    return f"{goal.subject} is {held}, not by one alone and {cm(THRESHOLDS.lifted_m)} up"


HELD_UP = GoalKind(
    word="held_up",
    complaint=_complaint,
    meaning=_meaning,
    evidence="held_up",
    shown=Shown(customer=True, moment=True, in_the_air=True),
    says="hold held holding keep up",
    claims="hold held holding",
    gloss=" (at the end, by one arm)",
    plain="{thing} is held up",
    commands="Hold up {0}.|Hold {0} up.|Hold {0} in the air.|Pick up {0} and hold it.|Please hold up {0}."
    "|Pick up {0} and keep it in the air.|Could you hold up {0}?|Take {0} and hold it up."
    "|Hold {0} above the table.|Keep {0} in the air.|{1} must be held up.",
    fleeting=True,
)
