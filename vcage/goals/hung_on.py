"""Hung on: a peg of a rack passes through the closed handle of a thing, which hangs there."""

from __future__ import annotations

from vcage.goals.kind import GoalKind, Shown, State, Stated, cm
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def _meaning(limits: Thresholds) -> str:
    return f"""
    Hung on: a peg of the reference passes through the closed handle of the thing, which hangs there at rest, let go,
    {cm(limits.hung_m)} or more above the table, and touches nothing but the reference. To lean against a peg, or to
    stand beside the reference, is not to hang on it.
    """


def _complaint(goal: Stated, state: State) -> str | None:
    thing, rack = goal.subject, str(goal.reference)
    if not state.hangs_on(thing, rack):
        return f"no peg of {rack} passes through the handle of {thing}"
    if others := state.touching(thing) - {rack}:
        return f"{thing} hangs on {rack}, and touches {', '.join(sorted(others))} too"
    if state.thing(thing).lowest - state.table_height < THRESHOLDS.hung_m:
        return f"{thing} hangs on {rack} less than {cm(THRESHOLDS.hung_m)} above the table"
    return None if state.at_rest(thing) else f"{thing} still swings on {rack}"


HUNG_ON = GoalKind(
    word="hung_on",
    complaint=_complaint,
    meaning=_meaning,
    evidence="hung",
    shown=Shown(customer=True, in_the_air=True),
    listed="`subject` has a closed handle, and `reference` a peg that comes to pass through it.",
    refers_to="object",
    says="hang hangs hung hook hooks hooked",
    claims="hang hangs hung",
    plain="{thing} hangs {where}",
    commands="Hang {0} on {2}.|Hang {0} up on {2}.|Hang {0} onto {2}.|Hang up {0} on {2}."
    "|Please hang {0} on {2}.|Could you hang {0} on {2}?|Take {0} and hang it on {2}."
    "|Pick up {0} and hang it on {2}.|Have {0} hung on {2}.|Hook {0} on {2} by its handle.|{1} must be hung on {2}.",
)
