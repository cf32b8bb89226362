"""Order of goals that no word of a sentence puts in order."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from vcage.plans.actions import HOLDING
from vcage.schema.goals import AskedGoal, Goal


def must_follow(before: Sequence[AskedGoal], after: Sequence[AskedGoal]) -> bool:
    """True if some goal of one command, said after another, must come after a goal of that."""
    return any(_in_order(a.goal, b.goal) for a, b in itertools.product(before, after))


def _in_order(before: Goal, goal: Goal) -> bool:
    """Check if a goal must come after another: it is of the same thing, or the other opens the way for it."""
    if goal.relation == "facing_robot" and before.relation in HOLDING and before.subject == goal.subject:
        return False  # it is put there so that it faces the robot
    if "upright" in (goal.relation, before.relation) and before.subject == goal.subject:
        return False  # it is put down standing
    part, place = (before, goal) if before.relation in ("open", "closed") else (goal, before)
    if part.relation not in ("open", "closed") or place.relation in ("open", "closed"):
        return before.subject == goal.subject and (before.part == goal.part or part.relation not in ("open", "closed"))
    return place.reference == part.subject and place.part in (None, part.part)
