"""The scene of stated goals: its objects with their roles, the goals, and the sentence that asks for them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from vcage.base.commands import vcage_command
from vcage.base.errors import NoFeasibleTask, UnknownName, UsageError
from vcage.base.text import listed
from vcage.goals import KINDS
from vcage.models.checked_reading import Instructed
from vcage.models.registry import third_reader
from vcage.models.same_reading import contradictions
from vcage.models.second_look import unmet_names
from vcage.models.selection_check import NamedObject, entries_of, instructed
from vcage.models.wordings import TaskToWord
from vcage.plans.actions import supersedes
from vcage.plans.consistency import inconsistencies
from vcage.runs.context import StageContext
from vcage.scenes.chosen_objects import Chosen, impossible
from vcage.scenes.starting_poses import started
from vcage.scenes.stated_goals import StatedGoal, StatedTask, shortened
from vcage.scenes.stated_names import object_meant, objects_of, split_part
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import AskedGoal, Description, Goal, Reading, part_that
from vcage.schema.plan import TABLE
from vcage.schema.scene import Role, SceneTemplate
from vcage.sim.robots import load_robot
from vcage.tasks.wording import template_wordings


def choose_stated(
    task: StatedTask, instruction: str | None, template: SceneTemplate, context: StageContext, rng: np.random.Generator
) -> tuple[str, Chosen]:
    """Return the stated objects and goals, and the instruction, or without one a sentence that asks for the goals.

    Raises:
        UnknownName: a name, look, part or arm is unknown; lists the known ones.
        UsageError: a name is ambiguous; goals are stated twice or contradict each other; no sentence says which objects
            a goal means; or the instruction contradicts the goals.
        NoFeasibleTask: its objects do not allow a goal.
        InfeasibleScene: an object does not fit into its place at the start.
    """
    objects = objects_of(task, context.catalogue, rng)
    goals, descriptions = _resolved(task, objects, context)
    kinds = entries_of(objects, context.catalogue)
    arms = load_robot(template.robot).arms
    for stated, one in zip(task.goals, goals, strict=True):
        _require_sense(stated, one, arms)
    _require_consistent(task, goals, descriptions)
    objects = [replace(o, role=_role(o.id, kinds[o.id], [one.goal for one in goals])) for o in objects]
    for description in descriptions:
        _require_place(description, kinds)
    objects = started(objects, Reading(goals=goals, descriptions=descriptions), context.library)
    if error := impossible(objects, Reading(goals=goals, descriptions=descriptions), template, context):
        raise error
    instruction = instruction or _sentence(goals, descriptions, objects, kinds)
    words = {"words": instruction}
    goals = [one.model_copy(update=words) for one in goals]
    descriptions = [one.model_copy(update=words) for one in descriptions]
    reading = Reading(goals=goals, descriptions=descriptions)
    _second_look(instruction, reading, objects, kinds, context.catalogue)
    return instruction, Chosen(objects, reading, [])


def _resolved(
    task: StatedTask, objects: Sequence[NamedObject], context: StageContext
) -> tuple[list[AskedGoal], list[Description]]:
    """Return goals and start conditions about objects of the scene."""
    catalogue = {entry.name: entry for entry in context.catalogue}
    goals, descriptions = [], []
    for stated in task.goals:
        place = _place(stated, objects, catalogue)
        _require_part(stated, place, catalogue[next(o.asset for o in objects if o.id == place["subject"])])
        goals.append(AskedGoal(goal=Goal.model_validate(place), step=stated.step, words=stated.text, arm=stated.arm))
    for stated in task.starts:
        place = _place(stated, objects, catalogue)
        descriptions.append(Description.model_validate({**place, "words": stated.text}))
    return goals, descriptions


def _place(
    stated: StatedGoal, objects: Sequence[NamedObject], catalogue: Mapping[str, CatalogueEntry]
) -> dict[str, str | None]:
    """Return the fields that goals and start conditions share."""
    meant = []
    for path, with_part in stated.names:
        name, part = split_part(path, catalogue, with_part)
        meant.append((object_meant(name, objects, stated), part))
    (subject, own_part), *others = meant
    reference, part = others[0] if others else (stated.reference, own_part)
    if reference == subject:
        raise UsageError(
            f"{shortened(stated.text)}: {subject} cannot be {stated.word} itself", hint="name another object"
        )
    return {"subject": subject, "relation": stated.word, "reference": reference, "part": part}


def _role(name: str, entry: CatalogueEntry, goals: Sequence[Goal]) -> Role:
    """Return the role that goals give an object."""
    own = [goal for goal in goals if goal.subject == name]
    words = {goal.relation for goal in goals}
    if any(goal.kind.acts_on is None for goal in own):
        return "content"
    if own or any(goal.reference == name for goal in goals):
        return "receptacle"
    return "tool" if entry.tool_for & words else "context"


def _sentence(
    goals: Sequence[AskedGoal],
    descriptions: Sequence[Description],
    objects: Sequence[NamedObject],
    kinds: Mapping[str, CatalogueEntry],
) -> str:
    """Return the plainest sentence that asks for the goals.

    Raises:
        UsageError: none tells the objects of a goal from others with the same name.
    """
    task = TaskToWord(
        instruction="",
        goals=goals,
        untouched=[],
        descriptions=descriptions,
        things=kinds,
        phrases={o.id: o.phrase for o in objects},
        lying={one.subject: one.reference for one in descriptions if one.relation in ("inside", "on")},
        tools=[o.id for o in objects if kinds[o.id].tool_for],
        catalogue=list(kinds.values()),
    )
    for sentence in template_wordings(task):
        return sentence
    shared = [o.id for o in objects if [other.phrase for other in objects].count(o.phrase) > 1]
    raise UsageError(
        f"no sentence can identify the objects of the goals: {listed(shared or kinds)} are called alike",
        hint="name other looks in --objects, tell them apart by --start 'plate_1 left_of plate_2', or say a sentence",
    )


def _second_look(
    instruction: str,
    reading: Reading,
    objects: Sequence[NamedObject],
    kinds: Mapping[str, CatalogueEntry],
    catalogue: Sequence[CatalogueEntry],
) -> None:
    """Check that the instruction agrees with the goals and names only objects of the scene.

    Raises:
        UsageError: it does not; names the missing requests.
    """

    def third(asked: Instructed) -> Reading:
        """Read without a model: stated goals leave nothing alone, and may have more starts than the instruction."""
        found = third_reader()(asked)
        return found.model_copy(update={"untouched": [], "descriptions": [*found.descriptions, *reading.descriptions]})

    unmet = unmet_names(instruction, catalogue, list(kinds.values()))
    if complaints := unmet + contradictions(instructed(instruction, objects, kinds), reading, third):
        raise UsageError(
            f"the goals do not match the instruction: {'; '.join(complaints)}",
            hint="add the goals that it lacks, say by --start where things lie or stand at first, or leave the "
            "instruction out",
            details={"complaints": complaints},
        )


# --- checks: unknown parts and arms, impossible actions, contradictions -------------------------------------------


def _require_part(stated: StatedGoal, place: Mapping[str, str | None], entry: CatalogueEntry) -> None:
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


def _require_sense(stated: StatedGoal, asked: AskedGoal, arms: Collection[str]) -> None:
    """Check that a goal names an existing arm, and uses the table only as a goal can."""
    arm = asked.goal.reference if asked.goal.kind.refers_to == "arm" else asked.arm
    if arm is not None and arm not in arms:
        raise UnknownName(f"arm in {shortened(stated.text)}:", arm, arms)
    if asked.goal.reference == TABLE and asked.goal.relation != "on":
        raise UsageError(f"{shortened(stated.text)}: of the table only 'on' can be a goal")


def _require_place(start: Description, kinds: Mapping[str, CatalogueEntry]) -> None:
    """Check that an object that starts in or on another can be put there."""
    if start.relation not in ("inside", "on") or start.reference == TABLE:
        return
    there = [("inside" if p.holds == "in" else "on", p.link) for p in kinds[start.reference].functional_points]
    if (start.relation, start.part) not in there:
        forms = [f"{word} {start.reference}{f'/{part}' if part else ''}" for word, part in dict.fromkeys(there)]
        asked = f"{start.relation} {start.reference}{f'/{start.part}' if start.part else ''}"
        raise _impossible(start.words, f"nothing can be {asked}; what can be: {listed(forms) or 'nothing'}")


def _require_consistent(task: StatedTask, goals: Sequence[AskedGoal], descriptions: Sequence[Description]) -> None:
    """Check that no goal is stated twice or true before its turn, and that nothing contradicts the rest."""
    true = {Goal(**one.model_dump(exclude={"words"})): 0 for one in descriptions if one.reference != TABLE}
    for stated, asked in zip(task.goals, goals, strict=True):
        goal, step = asked.goal, asked.step
        if true.get(goal) == step or (goal in true and not goal.kind.event):
            when = "at the start already" if not true[goal] else "said before"
            raise UsageError(f"{shortened(stated.text)} is {when}", hint="leave it out")
        true = {g: since for g, since in true.items() if since == step or not supersedes(goal, g)} | {goal: step}
    _require_starts_once(task.starts, descriptions)
    if found := inconsistencies(goals, descriptions):
        of_start = not inconsistencies(goals, [])
        hint = "leave one out" if of_start else "leave one out, or let a later goal begin with 'then'"
        raise UsageError(found[0], hint=hint)


def _require_starts_once(stated: Sequence[StatedGoal], descriptions: Sequence[Description]) -> None:
    """Check that no start is stated twice.

    Raises:
        UsageError: names it.
    """
    said = set[str]()
    for start, one in zip(stated, map(str, descriptions), strict=True):
        if one in said:
            raise UsageError(f"{shortened(start.text)} is said before", hint="leave it out, or name another object")
        said.add(one)


def _impossible(text: str, why: str) -> NoFeasibleTask:
    """Return the error of a goal that its objects do not allow."""
    return NoFeasibleTask(
        f"{shortened(text)}: {why}", hint="see what there is", command=vcage_command("assets", "list")
    )
