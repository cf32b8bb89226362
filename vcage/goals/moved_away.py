"""Moved away: an object stands farther out on its own side of the table than at the start of the episode."""

from __future__ import annotations

import numpy as np

from vcage.goals.kind import GoalKind, Shown, State, Stated, cm
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def outwards(started: np.ndarray, now: np.ndarray) -> float:
    """How far a thing at (3,) has come away from the table's middle, to the side where it started (3,), metres.

    In the middle itself it counts as one on the right.
    """
    return float(now[0] - started[0]) if started[0] >= 0 else float(started[0] - now[0])


def _meaning(limits: Thresholds) -> str:
    return f"""
    Moved away: the thing stands {cm(limits.away_m)} or more farther to the left than in `start` if it stood on the left
    half of the table, or farther to the right if on the right half.
    """


def _complaint(goal: Stated, state: State) -> str | None:
    far = outwards(state.at_start(goal.subject).pose.p, state.thing(goal.subject).pose.p)
    return None if far >= THRESHOLDS.away_m else f"{goal.subject} was moved outwards by {100 * far:.1f} cm only"


MOVED_AWAY = GoalKind(
    word="moved_away",
    complaint=_complaint,
    evidence="moved_away",
    meaning=_meaning,
    says="away aside outwards",
    claims="outwards",
    gloss=" (outwards on its own side of the table)",
    plain="{thing} was moved away",
    commands="Move {0} away.|Move {0} aside.|Move {0} outwards.|Bring {0} away from the middle.|Set {0} aside."
    "|Take {0} away to its side.|Please move {0} away.|Could you move {0} aside?|Put {0} aside.|{1} goes aside.",
    shown=Shown(start=True),
)
