"""Left of, right of, in front of, behind: one kind of goal in four directions, as the robot sees the table."""

from __future__ import annotations

from vcage.goals.kind import GoalKind, State, Stated, degrees
from vcage.goals.thresholds import Thresholds

LISTED = (
    '`subject` stands so to `reference`, as the robot sees it; in front is towards the robot. "next to" is `beside`.'
)


def stands_so(goal: Stated, state: State) -> str | None:
    """Why two objects do not stand to each other as a relation word says."""
    return None if state.stands(goal) else f"{goal.subject} is not {goal.relation} {goal.reference}"


def _meaning(limits: Thresholds) -> str:
    words = "Left of, right of, in front of, behind"
    return f"""
    {words}: as the robot sees it, so left is left in `top`, and in front is towards the lower
    edge of `top`. The thing's middle is beyond that edge of the other, and the line between the two middles is at most
    {degrees(limits.cone_rad)} off that direction. The distance does not matter.
    """


def _side(word: str, says: str, *prepositions: str, claims: str = "") -> GoalKind:
    return GoalKind(
        word=word,
        complaint=stands_so,
        evidence="related",
        meaning=_meaning,
        says=says,
        listed=LISTED,
        prepositions=prepositions,
        claims=claims,
        refers_to="object",
    )


SIDES = (
    _side("left_of", "left", "to the left of", "left of", "on the left side of"),
    _side("right_of", "right", "to the right of", "right of", "on the right side of"),
    _side("in_front_of", "front before", "in front of", "just in front of"),
    _side("behind", "behind back rear", "behind", "just behind", claims="behind"),
)
