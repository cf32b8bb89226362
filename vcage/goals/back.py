"""Back: an object stands again where it stood at the start of the episode."""

from __future__ import annotations

import numpy as np

from vcage.goals.kind import GoalKind, Shown, State, Stated, cm
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def _meaning(limits: Thresholds) -> str:
    return f"Back: the thing is at most {cm(limits.back_m)} from where it stood in `start`. It may be turned."


def _complaint(goal: Stated, state: State) -> str | None:
    now, stood = state.thing(goal.subject).pose.p, state.at_start(goal.subject).pose.p
    away = float(np.linalg.norm(now - stood))
    return None if away <= THRESHOLDS.back_m else f"{goal.subject} is {100 * away:.1f} cm from where it stood"


BACK = GoalKind(
    word="back",
    complaint=_complaint,
    evidence="returned",
    meaning=_meaning,
    says="back return returned stood before",
    claims="return returned",
    gloss=" (where it stood at the start)",
    plain="{thing} is back where it stood",
    commands="Put {0} back.|Put {0} back where it was.|Return {0} to its place.|Bring {0} back.|Set {0} back."
    "|Move {0} back to where it stood.|Place {0} where it stood before.|Please put {0} back."
    "|Could you put {0} back?|{1} goes back to its place.",
    shown=Shown(start=True),
)
