"""Upright: an object that lay on its side stands on its bottom, its head up."""

from __future__ import annotations

import numpy as np

from vcage.goals.kind import GoalKind, Shown, State, Stated, degrees
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def _meaning(limits: Thresholds) -> str:
    return f"""
    Upright: the thing, which lay on its side before, stands on its bottom with its head up, and leans by at most
    {degrees(limits.stood_up_rad)}. Lying on another side, or standing on its head, is not upright.
    """


def _complaint(goal: Stated, state: State) -> str | None:
    up = state.thing(goal.subject).pose.rotation()[2, 2]
    leans = float(np.arccos(np.clip(up, -1, 1)))
    if leans <= THRESHOLDS.stood_up_rad:
        return None
    return f"{goal.subject} leans by {np.degrees(leans):.0f}°"


UPRIGHT = GoalKind(
    word="upright",
    complaint=_complaint,
    evidence="upright",
    meaning=_meaning,
    says="upright stand stands stood up right",
    claims="upright",
    gloss=" (it lies on its side at the start, and is stood up)",
    plain="{thing} stands upright",
    commands="Stand {0} up.|Stand {0} upright.|Set {0} upright.|Put {0} upright.|Place {0} upright on the table."
    "|Turn {0} upright.|Please stand {0} up.|Could you stand {0} up?|Set {0} up on its bottom, upright."
    "|Have {0} stand upright.|{1} must stand upright.",
    shown=Shown(customer=True),
)
