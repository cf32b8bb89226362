"""Goals and starting conditions that cannot be true together."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import get_args

from vcage.plans.actions import AT_START, HOLDING, SLID, lasting, overrides
from vcage.plans.check import contradictions
from vcage.schema.goals import AskedGoal, Description, Goal, RelationWord, in_steps
from vcage.schema.plan import TABLE, Relation

_SAME_SIDE = {"row_left_of": "left_of"}
"""Word of a goal → the relation that it includes."""


def inconsistencies(goals: Sequence[AskedGoal], descriptions: Iterable[Description]) -> list[str]:
    """Goals of one step, or goals at the end, or starting conditions that contradict each other, one sentence each."""
    steps = in_steps(goals)
    # several may stand in the middle of the table
    placed = [d for d in descriptions if (d.relation, d.reference) != ("center", TABLE)]
    found = [f"the goals of one step contradict each other: {text}" for step in steps for text in _clashes(step)]
    end = lasting(steps)
    in_turn = (look(steps) for look in (_covered, _slid_from, _once_slid, _poured_on))
    for texts in (_clashes(end), _held_elsewhere(steps), _crowded(end), *in_turn):
        found = found or [f"the goals contradict each other: {text}" for text in texts]
    return found + [f"the start conditions contradict each other: {text}" for text in _clashes(placed)]


def unordered_contradictions(goals: Collection[Goal]) -> list[str]:
    """Contradictions between goals whose order is not known yet; parts may be opened and closed, things move once."""
    relations = _relations(goals)
    laid = {r.subject for r in relations if r.relation in HOLDING}
    twice = [r.subject for r, other in itertools.combinations(relations, 2) if r.subject == other.subject]
    return [*contradictions(relations), *(f"{name} is to be in two places" for name in twice if name in laid)]


def _held_elsewhere(steps: Sequence[Collection[Goal]]) -> list[str]:
    """Pairs of goals by which a thing is held up at the end and also stands somewhere, in words."""
    last = lasting(steps)
    held = [goal for goal in last if goal.kind.fleeting]
    own = ((one, goal) for one in held for goal in last if one.subject == goal.subject and goal.part is None)
    return [f"{one} and {goal}" for one, goal in own if one != goal]


def _crowded(goals: Sequence[Goal]) -> list[str]:
    """Goals by which two things are at one place of the start, or one thing at two."""
    at = {goal: goal.subject if goal.relation == AT_START else goal.reference for goal in goals if _of_start(goal)}
    pairs = itertools.combinations(at, 2)
    return [f"{a} and {b}" for a, b in pairs if (a.subject == b.subject) != (at[a] == at[b])]


def _covered(steps: Sequence[Collection[Goal]]) -> list[str]:
    """Pairs of goals by which a thing is put on another that is wiped later, which takes an empty one, in words."""
    found = list[str]()
    for step, put in _put_before(steps):
        wiped = {goal.subject: goal for goal in step if goal.relation == "wiped"}
        on = (goal for goal in put.values() if goal.relation == "on" and goal.part is None)
        found += [f"{goal} and then {wiped[place]}" for goal in on if (place := goal.reference) in wiped]
    return found


def _slid_from(steps: Sequence[Collection[Goal]]) -> list[str]:
    """Pairs of goals by which a thing is put in or on another and is hung or inserted from there later, in words."""
    return [
        f"{put[goal.subject]} and then {goal}, and only what stands on the table is {SLID[goal.relation]}"
        for step, put in _put_before(steps)
        for goal in step
        if goal.relation in SLID and goal.subject in put
    ]


def _once_slid(steps: Sequence[Collection[Goal]]) -> list[str]:
    """Pairs of goals of which the second is about a thing that is hung or inserted by the first, where no hand takes
    it, in words; other things may be put beside what is inserted."""
    found, slid = list[str](), dict[str | None, Goal]()
    for step in steps:
        for goal in step:
            before = [slid[goal.subject]] if goal.subject in slid else []
            other = slid.get(goal.reference)
            if other is not None and (other.relation != "inserted_in" or goal.relation in (*HOLDING, *SLID)):
                before.append(other)
            found += [f"{b} and then {goal}, and nothing more is done with what is {SLID[b.relation]}" for b in before]
        slid |= {goal.subject: goal for goal in step if goal.relation in SLID}
    return found


def _put_before(steps: Sequence[Collection[Goal]]) -> Iterator[tuple[Collection[Goal], dict[str, Goal]]]:
    """Each step with the goals by which things were put in or on others before, by thing."""
    put = dict[str, Goal]()
    for step in steps:
        yield step, put
        moved = {goal.subject for goal in step if goal.kind.moves and not goal.kind.event}
        held = {goal.subject: goal for goal in step if goal.relation in HOLDING and goal.reference != TABLE}
        put = {name: goal for name, goal in put.items() if name not in moved} | held


def _poured_on(steps: Sequence[Collection[Goal]]) -> list[str]:
    """Pairs of goals by which something is poured into what is not empty then, or on from there, in words."""
    poured = [goal for step in steps for goal in step if goal.relation == "poured"]
    pairs = itertools.combinations(poured, 2)
    return [f"{a} and {b}, as only what is empty is poured into" for a, b in pairs if _meet(a, b)]


def _meet(one: Goal, other: Goal) -> bool:
    """True where two goals name the same object."""
    return not {one.subject, one.reference}.isdisjoint((other.subject, other.reference))


def _of_start(goal: Goal) -> bool:
    """True where a goal names a place by what stood there at the start."""
    return goal.relation in (AT_START, "in_place_of")


def _clashes(stated: Iterable[Goal] | Iterable[Description]) -> list[str]:
    ordered = [one for _, one in sorted({str(one): one for one in stated}.items())]
    both = [f"{a} and {b}" for a, b in itertools.combinations(ordered, 2) if overrides(a, b)]
    return both + contradictions(_relations(ordered))


def _relations(stated: Iterable[Goal | Description]) -> list[Relation]:
    """Goals or descriptions as relations of a plan, where possible."""
    found = (one.model_dump(include={"subject", "relation", "reference"}) for one in stated)
    named = ({**one, "relation": _SAME_SIDE.get(one["relation"], one["relation"])} for one in found)
    return [Relation.model_validate(one) for one in named if one["relation"] in get_args(RelationWord)]
