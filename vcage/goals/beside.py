"""Beside: an object stands beside another, on any side."""

from __future__ import annotations

from vcage.goals.kind import GoalKind, cm
from vcage.goals.sides import LISTED, stands_so
from vcage.goals.thresholds import Thresholds


def _meaning(limits: Thresholds) -> str:
    return f"""
    Beside: seen from above, the two do not overlap, and the gap between the rectangles around them, with
    sides along the table's edges, is at most {cm(limits.beside_m)}, on any side.
    """


BESIDE = GoalKind(
    word="beside",
    complaint=stands_so,
    evidence="related",
    meaning=_meaning,
    says="beside next side alongside",
    listed=LISTED,
    prepositions=("beside", "next to", "by the side of"),
    refers_to="object",
)
