"""Inside: an object lies in another, or in a moving part of it such as a drawer."""

from __future__ import annotations

from vcage.goals.kind import GoalKind, State, Stated, cm, degrees, percent
from vcage.goals.thresholds import Thresholds

LISTED = (
    '`subject` is in or on `reference`; `part` when that is a part such as a drawer or a compartment, else "none". '
    "`reference` may be the `table`."
)


def meaning(limits: Thresholds) -> str:
    """The meaning of ``inside`` and ``on``."""
    share, lean = percent(limits.borne_share), degrees(limits.upright_rad)
    return f"""
    Inside or on an object: the middle of the thing is over the opening or top that it is put into or onto (at most
    {cm(limits.edge_m)} outside its edge), and at most {share} of its weight is on the table. Its lowest
    point is at most {cm(limits.height_m)} above or below the floor or top; in a deep opening it may be higher, up to
    {cm(limits.rim_m)} below the rim. The place itself leans by at most {lean}. So the thing may lie on
    its side, lean on a wall, stick out at the top, or lie on other things in the place; it may not lie across the rim.
    """


def complaint(goal: Stated, state: State) -> str | None:
    """Why the subject does not rest in or on the reference."""
    return state.not_resting(goal)


INSIDE = GoalKind(
    word="inside",
    complaint=complaint,
    evidence="placed",
    meaning=meaning,
    says="in into inside within",
    listed=LISTED,
    prepositions=("into", "in", "inside"),
    refers_to="object",
    part_of="reference",
)
