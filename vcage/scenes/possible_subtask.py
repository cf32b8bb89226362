"""Check that a sub-task of a file is possible in its scene: as strict as the search is."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

from vcage.runs.edits import Complaint
from vcage.scenes.possible import all_names, near_names, unknown_name
from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask
from vcage.sim.robots import load_robot
from vcage.tasks.asked_arms import arm_for, asked_arms
from vcage.tasks.choosing import moved_by
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.templates.proposal import Proposal
from vcage.tasks.templates.push import HEADINGS


def subtask_complaints(
    subtask: Subtask, field: str, scene: Scene, objects: Sequence[SceneObject]
) -> Iterator[Complaint]:
    """Yield complaints about a sub-task that the search would not make of a scene. No motion is tried.

    Only the first one is certain: later ones assume that there is none before.

    Args:
        subtask: as the file says.
        field: where it is in the file.
        scene: of the run.
        objects: of the scene.
    """
    by_id, arms = {o.id: o for o in objects}, load_robot(scene.robot).arms
    yield from _unknown_names(subtask, field, by_id, arms)
    yield from _unknown_points(subtask, field, by_id)
    for name in ("goals", "requires"):
        for number, goal in enumerate(getattr(subtask, name)):
            if unknown := unknown_name(goal, by_id, arms):
                yield f"{field}.{name}.{number}", f"there is no {unknown}", all_names(objects)
    yield from _wrong_arms(subtask, field, scene)
    yield from _wrong_choices(subtask, field, by_id)
    yield from _not_offered(subtask, field, scene, objects)


def _unknown_names(
    subtask: Subtask, field: str, objects: Collection[str], arms: Collection[str]
) -> Iterator[Complaint]:
    known = {"object": objects, "tool": objects, "grasped": objects, "receptacle": {*objects, TABLE}}
    known |= {"arm": arms, "hand_to": arms}
    named = [(place, getattr(subtask, place), names) for place, names in known.items()]
    named += [(f"grasps.{number}.arm", grasp.arm, arms) for number, grasp in enumerate(subtask.grasps)]
    for place, name, names in named:
        if name is not None and name not in names:
            yield f"{field}.{place}", repr(name), near_names(name, names)


def _unknown_points(subtask: Subtask, field: str, objects: Mapping[str, SceneObject]) -> Iterator[Complaint]:
    held = objects[subtask.grasped or subtask.object].asset.annotation
    contacts = [*range(len(HEADINGS))] if subtask.template == "push" else [point.id for point in held.contact_points]
    for number, grasp in enumerate(subtask.grasps):
        if grasp.contact not in contacts:
            yield f"{field}.grasps.{number}.contact", str(grasp.contact), f"one of {contacts}"
    holder = objects.get(subtask.receptacle or "")
    places = [point.id for point in holder.asset.annotation.functional_points] if holder else []
    if subtask.functional_point not in (None, *places):
        yield f"{field}.functional_point", str(subtask.functional_point), f"one of {places}"


def _wrong_arms(subtask: Subtask, field: str, scene: Scene) -> Iterator[Complaint]:
    """Yield arms other than those the instruction requires."""
    asked, why = arm_for(subtask.goals, asked_arms(scene.goals), subtask.hand_to)
    if why is not None:
        yield f"{field}.goals", why, "goals that one arm is asked to bring about"
    if asked is not None and subtask.arm != asked:
        yield f"{field}.arm", repr(subtask.arm), f"{asked!r}, as the instruction asks"
    if subtask.arm is None:
        return
    if subtask.hand_to == subtask.arm:
        yield f"{field}.hand_to", repr(subtask.hand_to), "another arm than the one that gives it"
    for number, grasp in enumerate(subtask.grasps):
        if grasp.arm != subtask.arm:
            yield f"{field}.grasps.{number}.arm", repr(grasp.arm), f"{subtask.arm!r}, the arm of the sub-task"


def _wrong_choices(subtask: Subtask, field: str, objects: Mapping[str, SceneObject]) -> Iterator[Complaint]:
    """Yield a preferred grasp missing in the grasps, and statements about objects of the sub-task."""
    grasps, prefers = [f"{g.contact} {g.arm}" for g in subtask.grasps], subtask.prefers
    if prefers is not None and f"{prefers.contact} {prefers.arm}" not in grasps:
        yield f"{field}.prefers", f"{prefers.contact} {prefers.arm}", f"one of its grasps: {', '.join(grasps)}"
    for number, statement in enumerate(subtask.statements):
        goal, where = statement.goal, f"{field}.statements.{number}"
        if unknown := unknown_name(goal or Goal(subject=statement.subject, relation="back"), objects, ()):
            yield where, f"there is no {unknown}", all_names([*objects.values()])
        if goal is None and statement.subject in moved_by(subtask):
            yield where, f"{statement.subject} is moved by the sub-task", "what it leaves where it is"


def _not_offered(subtask: Subtask, field: str, scene: Scene, objects: Sequence[SceneObject]) -> Iterator[Complaint]:
    """Yield a sub-task that its template does not propose: with this object, this receptacle and these goals."""
    if subtask.receptacle == subtask.object:
        yield f"{field}.receptacle", repr(subtask.receptacle), "another than the object itself"
    if subtask.template == "hand_over" and subtask.hand_to is None:
        yield f"{field}.hand_to", "null", "the arm that it is handed to"
    offered = _offering(subtask, scene, objects)
    mine = [proposal for proposal in offered if subtask.template in proposal.templates]
    if not mine:
        yield _wrong_template(subtask, field, offered)
    refusals = [proposal.impossible() for proposal in mine]
    if all(refusals):
        yield field, str(refusals[0] and refusals[0].reason), "what is possible by size"


def _offering(subtask: Subtask, scene: Scene, objects: Sequence[SceneObject]) -> list[Proposal]:
    """Return the proposals of all templates that a sub-task may be one of."""
    asked = {*subtask.goals, *(one.goal for one in scene.goals)}
    return [p for template in TEMPLATES.values() for p in template.proposals(objects, asked)[0] if p.offers(subtask)]


def _wrong_template(subtask: Subtask, field: str, offered: Sequence[Proposal]) -> Complaint:
    """Say that the template of a sub-task does not do that, and name those that do."""
    goals = " and ".join(map(str, subtask.goals))
    names = dict.fromkeys(name for proposal in offered for name in proposal.templates)
    wanted = " or ".join(names) or f"what {subtask.template} can do in this scene"
    found = f"{subtask.template} does not do that with {subtask.object}: {goals}"
    return (f"{field}.template" if offered else field), found, wanted
