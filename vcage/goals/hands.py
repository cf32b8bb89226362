"""Hands that hold an object in the air: several words ask for it."""

from __future__ import annotations

from vcage.goals.kind import TABLE, State, Stated
from vcage.goals.thresholds import THRESHOLDS


def in_hands(goal: Stated, state: State) -> set[str]:
    """The arms that alone hold the subject of a goal well above the table; none where anything else bears it too.

    What lies in it moves along, as long as it touches neither an arm nor the table.
    """
    touching = state.touching(goal.subject)
    high = state.thing(goal.subject).lowest - state.table_height >= THRESHOLDS.lifted_m
    borne = TABLE in touching or leans_on_another(goal, state)
    return touching & {*state.arms} if high and not borne else set()


def leans_on_another(goal: Stated, state: State) -> bool:
    """True where the subject of a goal touches something that an arm or the table bears: not what only lies in it."""
    bearing = {*state.arms, TABLE}
    return any(state.touching(name) & bearing for name in state.touching(goal.subject) - bearing)


def in_one_hand(goal: Stated, state: State) -> bool:
    """True where one arm alone holds the subject of a goal well above the table."""
    return len(in_hands(goal, state)) == 1
