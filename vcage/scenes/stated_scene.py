"""A scene for told goals: its objects with their roles, the goals among them, and the sentence that asks for these."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from vcage.base.errors import UsageError
from vcage.base.text import listed
from vcage.models.registry import third_reader
from vcage.models.same_reading import contradictions
from vcage.models.second_look import unmet_names
from vcage.models.selection_check import NamedObject, entries_of
from vcage.models.wordings import TaskToWord
from vcage.runs.context import StageContext
from vcage.scenes.chosen_objects import Chosen, impossible
from vcage.scenes.start_relations import started
from vcage.scenes.stated_checks import require_consistent, require_part, require_place, require_sense
from vcage.scenes.stated_goals import Said, Told, shortened
from vcage.scenes.stated_names import object_meant, objects_of, split_part
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import OF_A_PART, AskedGoal, Description, Goal, Reading
from vcage.schema.scene import Role, SceneTemplate
from vcage.sim.robots import load_robot
from vcage.tasks.task_wording import template_wordings


def choose_told(
    told: Told, instruction: str | None, template: SceneTemplate, context: StageContext, rng: np.random.Generator
) -> tuple[str, Chosen]:
    """The objects and goals as they were told, and the instruction; without one, a sentence that asks for the goals.

    Raises:
        UnknownName: a name, look, part or arm that there is not; lists what there is.
        UsageError: a name may mean several objects; goals are said twice or contradict each other; no sentence tells
            apart what a goal means; or the instruction says otherwise than the goals.
        NoFeasibleTask: a goal is one that its objects do not allow.
        InfeasibleScene: an object does not fit where it shall be at the start.
    """
    objects = objects_of(told, context.catalogue, rng)
    goals, descriptions = _resolved(told, objects, context)
    kinds = entries_of(objects, context.catalogue)
    arms = load_robot(template.robot).arms
    for said, one in zip(told.goals, goals, strict=True):
        require_sense(said, one, arms)
    require_consistent(told, goals, descriptions)
    objects = [replace(o, role=_role(o.id, kinds[o.id], [one.goal for one in goals])) for o in objects]
    for description in descriptions:
        require_place(description, kinds)
    objects = started(objects, descriptions, context.library)
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
    told: Told, objects: Sequence[NamedObject], context: StageContext
) -> tuple[list[AskedGoal], list[Description]]:
    """Goals and start conditions about objects of the scene."""
    catalogue = {entry.name: entry for entry in context.catalogue}
    goals, descriptions = [], []
    for said in told.goals:
        place = _place(said, objects, catalogue)
        require_part(said, place, catalogue[next(o.asset for o in objects if o.id == place["subject"])])
        goals.append(AskedGoal(goal=Goal.model_validate(place), step=said.step, words=said.text, arm=said.arm))
    for said in told.starts:
        place = _place(said, objects, catalogue)
        descriptions.append(Description.model_validate({**place, "words": said.text}))
    return goals, descriptions


def _place(
    said: Said, objects: Sequence[NamedObject], catalogue: Mapping[str, CatalogueEntry]
) -> dict[str, str | None]:
    """The fields that goals and start conditions share."""
    meant = []
    for path, with_part in said.names:
        name, part = split_part(path, catalogue, with_part)
        meant.append((object_meant(name, objects, said), part))
    (subject, own_part), *others = meant
    reference, part = others[0] if others else (said.reference, own_part)
    if reference == subject:
        raise UsageError(f"{shortened(said.text)}: {subject} cannot be {said.word} itself", hint="name another object")
    return {"subject": subject, "relation": said.word, "reference": reference, "part": part}


def _role(name: str, entry: CatalogueEntry, goals: Sequence[Goal]) -> Role:
    """The role that goals give an object."""
    own = [goal.relation for goal in goals if goal.subject == name]
    words = {goal.relation for goal in goals}
    if any(word not in OF_A_PART for word in own):
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
    """The plainest sentence that asks for the goals.

    Raises:
        UsageError: none tells apart what a goal means from what is called the same.
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
        f"no sentence tells which objects the goals mean: {listed(shared or kinds)} are called alike",
        hint="name other looks in --objects, tell them apart by --start 'plate_1 left_of plate_2', or say a sentence",
    )


def _second_look(
    instruction: str,
    reading: Reading,
    objects: Sequence[NamedObject],
    kinds: Mapping[str, CatalogueEntry],
    catalogue: Sequence[CatalogueEntry],
) -> None:
    """Check that the instruction does not say otherwise than the goals, and names nothing that is not there.

    Raises:
        UsageError: it does; names what the goals lack.
    """
    moved = [o.id for o in objects if o.role == "content"]
    lying = {o.id: o.starts_in for o in objects if o.starts_in is not None}

    def third(*read: Any) -> Reading:
        """Read without a model: told goals leave nothing alone, and may tell more starts than the instruction."""
        found = third_reader()(*read)
        return found.model_copy(update={"untouched": [], "descriptions": [*found.descriptions, *reading.descriptions]})

    unmet = unmet_names(instruction, catalogue, list(kinds.values()))
    if complaints := unmet + contradictions(instruction, kinds, reading, moved, lying, third):
        raise UsageError(
            f"the goals do not do what the instruction says: {'; '.join(complaints)}",
            hint="add the goals that it lacks, say by --start where things lie or stand at first, or leave the "
            "instruction out",
            details={"complaints": complaints},
        )
