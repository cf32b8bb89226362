"""Poured: a vessel in a hand was tipped over a container, and all that lay in the vessel lies in that now."""

from __future__ import annotations

import numpy as np

from vcage.goals.hands import in_one_hand
from vcage.goals.kind import GoalKind, Shown, State, Stated, cm, degrees
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def _meaning(limits: Thresholds) -> str:
    return f"""
    Poured: one arm alone held the thing {cm(limits.lifted_m)} or more above the table and tipped it by
    {degrees(limits.poured_rad)} or more, as `moment` shows, and all that lay in it before lies in the reference
    afterwards: not one is left in the thing, on the table, or on a rim. The thing itself stands upright on the table
    then, to within {degrees(limits.upright_rad)}.
    """


def _happens(goal: Stated, state: State, notes: set[str]) -> bool:
    """True once the vessel was tipped in a hand, and for as long as all lies in the reference then."""
    if not notes and _leans_rad(goal, state) >= THRESHOLDS.poured_rad and in_one_hand(goal, state):
        notes.add("tipped")
    return bool(notes) and not _amiss(goal, state)


def _leans_rad(goal: Stated, state: State) -> float:
    """Angle between the vessel's axis and upright."""
    return float(np.arccos(np.clip(state.thing(goal.subject).pose.rotation()[2, 2], -1, 1)))


def _amiss(goal: Stated, state: State) -> list[str]:
    """Ids of the contents that do not lie in the reference, or are still in the vessel."""
    vessel, target = goal.subject, str(goal.reference)
    return [name for name in state.contents(vessel) if state.lies_in(name, vessel) or not state.lies_in(name, target)]


def _complaint(goal: Stated, state: State) -> str | None:
    contents, amiss = state.contents(goal.subject), _amiss(goal, state)
    if not contents:
        return f"nothing lay in {goal.subject}"
    if amiss:
        there = f"{len(contents) - len(amiss)} of {len(contents)}"
        return f"{there} that lay in {goal.subject} lie in {goal.reference}, without {', '.join(amiss)}"
    if state.lasted_s(goal) < THRESHOLDS.poured_s:
        return f"{goal.subject} was not tipped in a hand until all lay in {goal.reference}"
    upright = _leans_rad(goal, state) <= THRESHOLDS.upright_rad
    on_table = abs(state.thing(goal.subject).lowest - state.table_height) <= THRESHOLDS.rim_m
    return None if upright and on_table else f"{goal.subject} does not stand upright on the table"


POURED = GoalKind(
    word="poured",
    event=True,
    happens=_happens,
    complaint=_complaint,
    meaning=_meaning,
    evidence="poured",
    shown=Shown(customer=True, moment=True, in_the_air=True),
    listed="`subject` is a vessel with loose things in it, all of which are tipped into `reference`.",
    refers_to="object",
    says="pour poured pours empty emptied tip tipped tips dump dumped",
    claims="pour pours poured",
    plain="the contents of {thing} were poured {where}",
    commands="Pour {0} into {2}.|Empty {0} into {2}.|Tip {0} out into {2}.|Pour out {0} into {2}."
    "|Pour the contents of {0} into {2}.|Pour what is in {0} into {2}.|Please pour {0} into {2}."
    "|Could you empty {0} into {2}?|Take {0} and pour it into {2}.|Dump {0} into {2}.|Have {0} poured into {2}."
    "|{1} must be poured into {2}.",
)
