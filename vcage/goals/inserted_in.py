"""Inserted in: the shaft of a thing lies in a hole of another one, in line with it and deep enough."""

from __future__ import annotations

from vcage.goals.kind import GoalKind, Shown, State, Stated, cm, degrees, percent
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def _meaning(limits: Thresholds) -> str:
    return f"""
    Inserted in: the thing lies at rest in a hole of the reference, let go, over {percent(limits.inserted_share)} or
    more of the length of the hole, its axis within {degrees(limits.inserted_rad)} and {cm(limits.inserted_aside_m)} of
    that of the hole, and touches nothing but the reference. To lie before the hole, on the reference or beside it, or
    to stick in the mouth of the hole, is not to be inserted.
    """


def _complaint(goal: Stated, state: State) -> str | None:
    thing, place = goal.subject, str(goal.reference)
    lies = state.inserted(thing, place)
    if lies is None or lies.share <= 0:
        return f"{thing} is in no hole of {place}"
    if lies.share < THRESHOLDS.inserted_share:
        need = percent(THRESHOLDS.inserted_share)
        return f"{thing} fills {100 * lies.share:.0f} % of the length of the hole of {place}, and {need} are needed"
    if lies.leans_rad > THRESHOLDS.inserted_rad or lies.aside_m > THRESHOLDS.inserted_aside_m:
        return f"{thing} is not in line with the hole of {place}"
    if others := state.touching(thing) - {place}:
        return f"{thing} is in the hole of {place}, and touches {', '.join(sorted(others))} too"
    return None if state.at_rest(thing) else f"{thing} still moves in the hole of {place}"


INSERTED_IN = GoalKind(
    word="inserted_in",
    complaint=_complaint,
    meaning=_meaning,
    evidence="inserted",
    shown=Shown(customer=True),
    listed="`subject` has a shaft, such as a peg, and `reference` a hole into which that goes.",
    refers_to="object",
    says="insert inserts inserted put puts push pushes slide slides stick sticks plug plugs plugged into in hole",
    claims="plug plugs plugged",
    plain="{thing} is inserted {where}",
    commands="Insert {0} into {2}.|Insert {0} in {2}.|Put {0} into the hole of {2}.|Push {0} into the hole of {2}."
    "|Slide {0} into the hole of {2}.|Stick {0} into the hole of {2}.|Please insert {0} into {2}."
    "|Could you push {0} into the hole of {2}?|Take {0} and insert it into {2}.|Have {0} inserted into {2}."
    "|Plug {0} into {2}.|{1} must be inserted into {2}.",
)
