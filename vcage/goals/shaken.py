"""Shaken: one arm tilted an object to and fro in the air."""

from __future__ import annotations

import numpy as np

from vcage.goals.hands import in_one_hand
from vcage.goals.kind import GoalKind, Shown, State, Stated, cm, degrees
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def _meaning(limits: Thresholds) -> str:
    return f"""
    Shaken: while one arm alone held the thing {cm(limits.lifted_m)} or more above the table, it leaned to one side by
    {degrees(limits.shaken_rad)} or more, then to the other, and so on, {limits.shaken_times} times in all: to one side
    in `moment`, to the other in `later`.
    """


def _happens(goal: Stated, state: State, notes: set[str]) -> bool:
    """True once it has leaned to and fro often enough; ``notes`` keeps each lean as x and y of its upright axis.

    The last one follows the object while it stays on that side: what leaned when it was lifted may lean any other way
    when it is shaken.
    """
    if not in_one_hand(goal, state):
        notes.clear()
        return False
    upright = int(np.abs(state.at_start(goal.subject).pose.rotation()[2]).argmax())
    lean = state.thing(goal.subject).pose.rotation()[:2, upright]
    if np.linalg.norm(lean) >= np.sin(THRESHOLDS.shaken_rad):
        last = max(notes, default=None)
        if last is not None and lean @ np.array(last.split()[1:], float) >= 0:
            notes.remove(last)
        notes.add(f"{len(notes):03d} {lean[0]} {lean[1]}")
    return len(notes) >= THRESHOLDS.shaken_times


def _complaint(goal: Stated, state: State) -> str | None:
    return None if state.lasted_s(goal) > 0 else f"{goal.subject} was not tilted to and fro often enough in the air"


SHAKEN = GoalKind(
    word="shaken",
    event=True,
    happens=_happens,
    complaint=_complaint,
    meaning=_meaning,
    evidence="shaken",
    shown=Shown(customer=True, moment=True, later=True, in_the_air=True),
    says="shake shaken shakes shook",
    claims="shake shaken shakes",
    plain="{thing} was shaken",
    commands="Shake {0}.|Shake {0} well.|Give {0} a shake.|Pick up {0} and shake it.|Please shake {0}."
    "|Could you shake {0}?|Could you give {0} a shake?|Shake {0} a few times.|Get {0} shaken.|Have {0} shaken."
    "|{1} must be shaken.",
)
