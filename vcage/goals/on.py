"""On: an object stands on another, or on the table."""

from __future__ import annotations

from dataclasses import replace

from vcage.goals.hands import leans_on_another
from vcage.goals.inside import LISTED, complaint, meaning
from vcage.goals.kind import GoalKind, State, Stated, cm
from vcage.goals.thresholds import THRESHOLDS, Thresholds

ON = GoalKind(
    word="on",
    complaint=complaint,
    evidence="placed",
    meaning=meaning,
    says="on onto upon top",
    listed=LISTED,
    prepositions=("onto", "on", "on top of"),
    refers_to="object",
    part_of="reference",
)


def _meaning_on_table(limits: Thresholds) -> str:
    return f"""
    On the table: the thing touches no object but what lies in or on it, and its lowest point is at most
    {cm(limits.height_m)} off the table top. It may lie on its side.
    """


def _complaint_on_table(goal: Stated, state: State) -> str | None:
    stands = abs(state.thing(goal.subject).aabb[0, 2] - state.table_height) <= THRESHOLDS.height_m
    return None if stands and not leans_on_another(goal, state) else f"{goal.subject} does not stand on the table alone"


ON_TABLE = replace(ON, complaint=_complaint_on_table, evidence="moved", meaning=_meaning_on_table)
"""The same word of the table."""
