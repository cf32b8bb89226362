"""The planner, and the check of its chains, beside the validator of unified-planning."""

from __future__ import annotations

from collections.abc import Sequence

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from unified_planning.engines.plan_validator import SequentialPlanValidator
from unified_planning.plans import ActionInstance, SequentialPlan
from unified_planning.shortcuts import BoolType, Fluent, InstantaneousAction, Not, Problem, get_environment

from vcage.plans.actions import Action, State, overrides
from vcage.plans.planner import Task, complaints, find_chain
from vcage.schema.goals import Goal

get_environment().credits_stream = None
THINGS, DRAWERS = ("pen", "cup", "tray"), ("top", "bottom")


def at(thing: str, place: str) -> Goal:
    """A thing in the cup, a drawer (``top``), on the tray or on the table."""
    if place in DRAWERS:
        return Goal(subject=thing, relation="inside", reference="cabinet", part=place)
    return Goal(subject=thing, relation="inside" if place == "cup" else "on", reference=place)


def drawer(word: str, part: str) -> Goal:
    return Goal(subject="cabinet", relation=word, part=part)  # pyrefly: ignore


START: State = frozenset([*(at(t, "table") for t in THINGS), *(drawer("closed", d) for d in DRAWERS)])


def actions() -> list[Action]:
    """Every thing to every place, every drawer open and shut; the top one must be shut to get at the bottom one."""
    found = []
    for part in DRAWERS:
        above = [drawer("closed", "top")] if part == "bottom" else []
        for word, other in (("open", "closed"), ("closed", "open")):
            needs = frozenset([drawer(other, part), *above])
            found.append(Action(f"{word}-{part}", needs, frozenset([drawer(word, part)])))
    for thing in THINGS:
        for place in ("cup", "tray", "table", *DRAWERS):
            if place != thing:
                above = [drawer("closed", "top")] if place == "bottom" else []
                needs = frozenset([drawer("open", place), *above] if place in DRAWERS else [])
                found.append(Action(f"{thing}-{place}", needs, frozenset([at(thing, place)]), moves=thing))
    return found


BY_NAME = {action.name: action for action in actions()}


def chain_for(*steps: Sequence[Goal]) -> list[str] | None:
    return find_chain(Task(START, tuple(map(frozenset, steps))), actions())


def test_a_drawer_is_opened_where_something_is_put_in_and_stays_open() -> None:
    assert chain_for([at("pen", "top")]) == ["open-top", "pen-top"]


def test_a_drawer_that_shall_be_open_stays_open() -> None:
    assert chain_for([drawer("open", "top")], [at("pen", "top")]) == ["open-top", "pen-top"]


def test_a_drawer_is_closed_on_request() -> None:
    assert chain_for([at("pen", "top")], [drawer("closed", "top")]) == ["open-top", "pen-top", "closed-top"]


def test_a_drawer_in_the_way_of_another_is_closed_or_opened_last() -> None:
    assert chain_for([at("pen", "top"), at("cup", "bottom")]) == ["open-bottom", "cup-bottom", "open-top", "pen-top"]
    chain = chain_for([at("pen", "top")], [at("cup", "bottom")])
    assert chain == ["open-top", "pen-top", "closed-top", "open-bottom", "cup-bottom"]


def test_the_order_of_the_steps_is_kept() -> None:
    assert chain_for([at("cup", "tray")], [at("pen", "tray")]) == ["cup-tray", "pen-tray"]
    assert chain_for([at("pen", "tray")], [at("cup", "tray")]) == ["pen-tray", "cup-tray"]


def test_an_object_is_moved_as_often_as_requested() -> None:
    assert chain_for([at("pen", "cup")], [at("pen", "tray")]) == ["pen-cup", "pen-tray"]


def test_contents_are_taken_out_before_their_container_is_moved() -> None:
    laden = (START - {at("pen", "table")}) | {at("pen", "cup")}
    chain = find_chain(Task(laden, (frozenset([at("cup", "tray")]),)), actions())
    assert chain == ["pen-table", "cup-tray"]


def test_a_goal_true_at_the_start_must_still_be_brought_about() -> None:
    assert chain_for([drawer("closed", "top")]) == ["open-top", "closed-top"]


def test_without_an_action_for_a_goal_there_is_no_chain() -> None:
    assert chain_for([Goal(subject="pen", relation="scanned")]) is None


@pytest.mark.parametrize(
    ("chain", "complaint"),
    [
        (["pen-top"], "pen-top is not possible then: cabinet/top open must be true first"),
        (["open-top"], "pen inside cabinet/top is not brought about in its turn"),
        (["open-top", "pen-top", "pen-table"], "pen inside cabinet/top is not true at the end"),
        (["open-top", "pen-top"], None),
    ],
)
def test_a_chain_is_checked_step_by_step(chain: list[str], complaint: str | None) -> None:
    task = Task(START, (frozenset([at("pen", "top")]),))
    found = complaints(task, [BY_NAME[name] for name in chain])
    assert found == ([] if complaint is None else [complaint]) or complaint in found


def test_a_goal_achieved_too_early_is_not_in_order() -> None:
    task = Task(START, (frozenset([at("pen", "tray")]), frozenset([at("cup", "tray")])))
    found = complaints(task, [BY_NAME["cup-tray"], BY_NAME["pen-tray"]])
    assert found == ["cup-tray comes before what must be done first"]


GOALS = st.sampled_from([a for action in actions() for a in action.adds])


@settings(max_examples=40, deadline=None)
@given(st.lists(st.lists(GOALS, min_size=1, max_size=2, unique=True), min_size=1, max_size=3))
def test_every_chain_found_is_proven_and_valid_for_another_planner(steps: list[list[Goal]]) -> None:
    assume(not any(overrides(a, b) for step in steps for a in step for b in step))
    task = Task(START, tuple(map(frozenset, steps)))
    chain = find_chain(task, actions())
    if chain is None:
        return
    assert complaints(task, [BY_NAME[name] for name in chain]) == []
    assert _is_valid_elsewhere(task, chain)


def _is_valid_elsewhere(task: Task, chain: Sequence[str]) -> bool:
    """True if unified-planning's validator agrees that the chain leads to the goals."""
    facts = {g for action in actions() for g in (*action.adds, *action.requires)} | set(task.initial)
    fluents = {goal: Fluent(str(goal).replace(" ", "_").replace("/", "__"), BoolType()) for goal in facts}
    problem = Problem("chain")
    for goal, fluent in fluents.items():
        problem.add_fluent(fluent, default_initial_value=goal in task.initial)
    theirs = {name: _translated(action, fluents) for name, action in BY_NAME.items()}
    problem.add_actions(theirs.values())
    for goal in task.final:
        problem.add_goal(fluents[goal])
    plan = SequentialPlan([ActionInstance(theirs[name]) for name in chain])
    return bool(SequentialPlanValidator().validate(problem, plan))


def _translated(action: Action, fluents: dict[Goal, Fluent]) -> InstantaneousAction:
    theirs = InstantaneousAction(action.name.replace("-", "_"))
    for goal in action.requires:
        theirs.add_precondition(fluents[goal])
    for goal, fluent in fluents.items():
        if goal.reference is not None and goal.reference == action.moves:
            theirs.add_precondition(Not(fluent))
        moved = action.moves is not None and goal.subject == action.moves and not goal.kind.event
        if goal in action.adds:
            theirs.add_effect(fluent, True)
        elif moved or any(overrides(new, goal) for new in action.adds):
            theirs.add_effect(fluent, False)
    return theirs


@pytest.mark.parametrize(("along", "chain"), [(True, ["pen-cup", "lift-cup"]), (False, None)], ids=["level", "tips"])
def test_what_an_earlier_step_put_in_a_thing_is_in_it_when_that_is_lifted(along: bool, chain: list[str] | None) -> None:
    lifted = frozenset([Goal(subject="cup", relation="lifted")])
    task = Task(START, (frozenset([at("pen", "cup")]), lifted))
    lift = Action("lift-cup", frozenset(), lifted, moves="cup", along=along)
    assert find_chain(task, [*actions(), lift]) == chain
