"""Weighed: an object lay still on a scale that bore nothing else."""

from __future__ import annotations

from vcage.goals.kind import TABLE, GoalKind, Shown, State, Stated, too_short
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def _meaning(limits: Thresholds) -> str:
    return f"""
    Weighed: the thing lay still on the scale and touched nothing else for {limits.weighed_s:g} s, while the
    scale touched nothing else but the table. Whether the display shows a number does not matter.
    """


def _complaint(goal: Stated, state: State) -> str | None:
    return too_short(goal, state, THRESHOLDS.weighed_s)


def _happens(goal: Stated, state: State, notes: set[str]) -> bool:
    """True where it lies still on a scale, and nothing else does."""
    name = goal.subject
    if state.speed_m_per_s(name) > THRESHOLDS.still_m_per_s:
        return False
    bearers = state.touching(name)
    if len(bearers) != 1:
        return False
    (scale,) = bearers
    return state.weighs(scale) and state.touching(scale) <= {name, TABLE}


WEIGHED = GoalKind(
    word="weighed",
    complaint=_complaint,
    evidence="weighed",
    meaning=_meaning,
    says="weigh weighs weighed weight heavy",
    claims="weigh weighs weighed",
    plain="{thing} was weighed",
    commands="Weigh {0}.|Weigh {0} on the scale.|Put {0} on the scale and weigh it.|Find out how heavy {0} is."
    "|Check the weight of {0}.|Please weigh {0}.|Could you weigh {0}?|Have {0} weighed.|Get {0} weighed."
    "|See what {0} weighs.|{1} must be weighed.",
    event=True,
    happens=_happens,
    tool="weighs",
    shown=Shown(moment=True),
)
