"""In place of: an object stands where another one stood at the start of the episode."""

from __future__ import annotations

import numpy as np

from vcage.goals.kind import GoalKind, Shown, State, Stated, cm
from vcage.goals.sides import LISTED
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def off_place(box: np.ndarray, other: np.ndarray) -> float:
    """Distance in the plane between the middle of a box (2, 3) and that of another object at the start, metres."""
    return float(np.linalg.norm((box - other).mean(axis=0)[:2]))


def _meaning(limits: Thresholds) -> str:
    return f"""
    In place of: seen from above, the middle of the thing is at most {cm(limits.swapped_m)} from where the middle of the
    other one was in `start`. Where that one is now does not matter.
    """


def _complaint(goal: Stated, state: State) -> str | None:
    away = off_place(state.thing(goal.subject).aabb, state.at_start(str(goal.reference)).aabb)
    far = f"{goal.subject} is {100 * away:.1f} cm from where {goal.reference} stood"
    return None if away <= THRESHOLDS.swapped_m else far


IN_PLACE_OF = GoalKind(
    word="in_place_of",
    complaint=_complaint,
    evidence="in_place_of",
    meaning=_meaning,
    says="place where stood was swap exchange",
    claims="swap exchange",
    listed=LISTED,
    gloss=" (where the other stood at the start; of two that change places each says so of the other)",
    prepositions=("at the old place of", "at the first place of", "at the former place of"),
    refers_to="object",
    shown=Shown(start=True),
)
