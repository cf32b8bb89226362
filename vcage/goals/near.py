"""Near: an object stands near another, on any side."""

from __future__ import annotations

from vcage.goals.kind import GoalKind, cm
from vcage.goals.sides import LISTED, stands_so
from vcage.goals.thresholds import Thresholds


def _meaning(limits: Thresholds) -> str:
    return f"""
    Near: seen from above, the two do not overlap, and the gap between the rectangles around them, with
    sides along the table's edges, is at most {cm(limits.near_m)}, on any side.
    """


NEAR = GoalKind(
    word="near",
    complaint=stands_so,
    evidence="related",
    meaning=_meaning,
    says="near nearby close far",
    listed=LISTED,
    prepositions=("near", "close to", "not far from"),
    refers_to="object",
)
