"""Checks of stated goals: unknown parts and arms, impossible actions, contradictions."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from vcage.base.commands import vcage_command
from vcage.base.errors import NoFeasibleTask, UnknownName, UsageError
from vcage.base.text import listed
from vcage.goals import KINDS
from vcage.plans.actions import supersedes
from vcage.plans.consistency import inconsistencies
from vcage.scenes.stated_goals import StatedGoal, StatedTask, shortened
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import AskedGoal, Description, Goal, part_that
from vcage.schema.plan import TABLE


def require_part(stated: StatedGoal, place: Mapping[str, str | None], entry: CatalogueEntry) -> None:
    """Check that a part to be operated exists and can be operated so."""
    action = KINDS[stated.word].acts_on if stated.word in KINDS else None
    if action is None:
        return
    subject, part = place["subject"], place["part"]
    able = [name for name in entry.moving_parts if part_that(action, name)]
    if not able:
        raise _impossible(stated.text, f"{subject} has no part that can be {stated.word}")
    if part is None:
        raise UsageError(
            f"{shortened(stated.text)}: {stated.word!r} needs a moving part",
            hint=f"write {' or '.join(f'{subject}/{name} {stated.word}' for name in able)}",
        )
    if part not in able:
        raise UnknownName(f"part of {subject} that can be {stated.word} in {shortened(stated.text)}:", part, able)


def require_sense(stated: StatedGoal, asked: AskedGoal, arms: Collection[str]) -> None:
    """Check that a goal names an existing arm, and of the table only what can be a goal."""
    arm = asked.goal.reference if asked.goal.kind.refers_to == "arm" else asked.arm
    if arm is not None and arm not in arms:
        raise UnknownName(f"arm in {shortened(stated.text)}:", arm, arms)
    if asked.goal.reference == TABLE and asked.goal.relation != "on":
        raise UsageError(f"{shortened(stated.text)}: of the table only 'on' can be a goal")


def require_place(start: Description, kinds: Mapping[str, CatalogueEntry]) -> None:
    """Check that a thing that starts in or on another can be put there."""
    if start.relation not in ("inside", "on") or start.reference == TABLE:
        return
    there = [("inside" if p.holds == "in" else "on", p.link) for p in kinds[start.reference].functional_points]
    if (start.relation, start.part) not in there:
        forms = [f"{word} {start.reference}{f'/{part}' if part else ''}" for word, part in dict.fromkeys(there)]
        asked = f"{start.relation} {start.reference}{f'/{start.part}' if start.part else ''}"
        raise _impossible(start.words, f"nothing can be {asked}; what can be: {listed(forms) or 'nothing'}")


def require_consistent(task: StatedTask, goals: Sequence[AskedGoal], descriptions: Sequence[Description]) -> None:
    """Check that no goal is stated twice or true before its turn, and that nothing contradicts the rest."""
    true = {_as_goal(one): 0 for one in descriptions if one.reference != TABLE}
    for stated, asked in zip(task.goals, goals, strict=True):
        goal, step = asked.goal, asked.step
        if true.get(goal) == step or (goal in true and not goal.kind.event):
            when = "at the start already" if not true[goal] else "said before"
            raise UsageError(f"{shortened(stated.text)} is {when}", hint="leave it out")
        true = {g: since for g, since in true.items() if since == step or not supersedes(goal, g)} | {goal: step}
    if found := inconsistencies(goals, descriptions):
        of_start = not inconsistencies(goals, [])
        hint = "leave one out" if of_start else "leave one out, or let a later goal begin with 'then'"
        raise UsageError(found[0], hint=hint)


def _as_goal(one: Description) -> Goal:
    return Goal.model_validate(one.model_dump(exclude={"words"}))


def _impossible(text: str, why: str) -> NoFeasibleTask:
    """Return the error of a goal that its objects do not allow."""
    return NoFeasibleTask(
        f"{shortened(text)}: {why}", hint="see what there is", command=vcage_command("assets", "list")
    )
