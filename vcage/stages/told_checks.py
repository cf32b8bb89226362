"""Told goals that make no sense: parts and arms that there are not, things that cannot be done, contradictions."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping, Sequence
from typing import get_args

from vcage.base.commands import vcage_command
from vcage.base.errors import NoFeasibleTask, UnknownName, UsageError
from vcage.base.text import listed
from vcage.plans.actions import EVENTS, lasting, overrides, supersedes
from vcage.plans.check import contradictions
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import OF_A_PART, AskedGoal, Description, Goal, RelationWord, in_steps, part_that
from vcage.schema.plan import TABLE, Relation
from vcage.stages.told_goals import Said, Told, shortened
from vcage.stages.told_names import reads_codes, weighs

_AXES = (("left_of", "right_of"), ("in_front_of", "behind"))
_CARRIED = ("inside", "on", "weighed", "presented", "handed", "back")
_ACTIONS = {"open": "open", "closed": "open", "pressed": "press", "turned": "turn"}


def require_part(said: Said, place: Mapping[str, str | None], entry: CatalogueEntry) -> None:
    """Check that a part which is to be operated is there, and is one that can be."""
    if said.word not in OF_A_PART:
        return
    subject, part = place["subject"], place["part"]
    able = [name for name in entry.moving_parts if part_that(_ACTIONS[said.word], name)]
    if not able:
        raise impossible(said.text, f"{subject} has no part that can be {said.word}")
    if part is None:
        raise UsageError(
            f"{shortened(said.text)}: {said.word!r} is said of a moving part",
            hint=f"write {' or '.join(f'{subject}/{name} {said.word}' for name in able)}",
        )
    if part not in able:
        raise UnknownName(f"part of {subject} that can be {said.word} in {shortened(said.text)}:", part, able)


def impossible(text: str, why: str) -> NoFeasibleTask:
    """The error about a goal or start condition that its objects do not allow."""
    return NoFeasibleTask(
        f"{shortened(text)}: {why}", hint="see what there is", command=vcage_command("assets", "list")
    )


def require_sense(said: Said, asked: AskedGoal, kinds: Mapping[str, CatalogueEntry], arms: Collection[str]) -> None:
    """Check that the objects and arms of a goal allow it, whatever their sizes."""
    goal = asked.goal
    arm = goal.reference if goal.relation == "handed" else asked.arm
    if arm is not None and arm not in arms:
        raise UnknownName(f"arm in {shortened(said.text)}:", arm, arms)
    if goal.reference == TABLE and goal.relation != "on":
        raise UsageError(f"{shortened(said.text)}: of the table only 'on' can be a goal")
    why = _carrying_refusal(goal, kinds) or place_refusal(goal, kinds) or _tool_refusal(goal, kinds)
    if why:
        raise impossible(said.text, why)


def _carrying_refusal(goal: Goal, kinds: Mapping[str, CatalogueEntry]) -> str | None:
    carried = goal.relation not in _CARRIED or kinds[goal.subject].can_be_carried
    return None if carried else f"{goal.subject} cannot be carried: no gripper can hold it"


def place_refusal(goal: Goal | Description, kinds: Mapping[str, CatalogueEntry]) -> str | None:
    """Why nothing can be put there; None where it can, or the goal is no such."""
    if goal.relation not in ("inside", "on") or goal.reference == TABLE:
        return None
    points = kinds[str(goal.reference)].functional_points
    there = [("inside" if p.holds == "in" else "on", p.link) for p in points]
    if (goal.relation, goal.part) in there:
        return None
    forms = [f"{word} {goal.reference}{f'/{part}' if part else ''}" for word, part in dict.fromkeys(there)]
    asked = f"{goal.relation} {goal.reference}{f'/{goal.part}' if goal.part else ''}"
    return f"nothing can be {asked}; what can be: {listed(forms) or 'nothing'}"


def _tool_refusal(goal: Goal, kinds: Mapping[str, CatalogueEntry]) -> str | None:
    """Why it cannot be scanned or weighed; None where it can, or the goal is no such."""
    others = [kinds[name] for name in kinds if name != goal.subject]
    if goal.relation == "scanned":
        if all(face.kind != "code" for face in kinds[goal.subject].faces):
            return f"{goal.subject} has no bar code"
        return None if any(map(reads_codes, others)) else "no scanner stands there"
    if goal.relation == "weighed" and not any(map(weighs, others)):
        return "no scale stands there"
    return None


def require_consistent(told: Told, goals: Sequence[AskedGoal], descriptions: Sequence[Description]) -> None:
    """Check that no goal is said twice or true before its turn, and that nothing contradicts the rest."""
    true = {_as_goal(one): 0 for one in descriptions if one.reference != TABLE}
    for said, asked in zip(told.goals, goals, strict=True):
        goal, step = asked.goal, asked.step
        if true.get(goal) == step or (goal in true and goal.relation not in EVENTS):
            when = "at the start already" if not true[goal] else "said before"
            raise UsageError(f"{shortened(said.text)} is {when}", hint="leave it out")
        true = {g: since for g, since in true.items() if since == step or not supersedes(goal, g)} | {goal: step}
    steps = in_steps(goals)
    for step in steps:
        _require_possible(sorted(step, key=str), "goals of one step", ", or let a later one begin with 'then'")
    _require_possible(lasting(steps), "goals")
    _require_possible([_as_goal(one) for one in descriptions if one.reference != TABLE], "start conditions")
    sides = [
        (one.subject, axis) for one in descriptions for axis in _AXES if one.reference == TABLE and one.relation in axis
    ]
    for subject, axis in sides:
        if sides.count((subject, axis)) > 1:
            raise UsageError(f"the start conditions contradict each other: {subject} is {' and '.join(axis)} the table")


def _as_goal(one: Description) -> Goal:
    return Goal.model_validate(one.model_dump(exclude={"words"}))


def _require_possible(goals: Sequence[Goal], what: str, other_way: str = "") -> None:
    """Check that goals can be true together."""
    both = [f"{a} and {b}" for a, b in itertools.combinations(goals, 2) if overrides(a, b)]
    places = [g for g in goals if g.relation in get_args(RelationWord)]
    relations = [Relation.model_validate(g.model_dump(include={"subject", "relation", "reference"})) for g in places]
    if found := both or contradictions(relations):
        raise UsageError(f"the {what} contradict each other: {found[0]}", hint=f"leave one out{other_way}")
