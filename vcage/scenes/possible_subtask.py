"""Check that a sub-task that was written or edited by hand is possible in its scene: as strict as the search is."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NoReturn

from vcage.runs.edits import refuse
from vcage.scenes.known_names import all_names, near_names, unknown_name
from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask
from vcage.sim.robots import load_robot
from vcage.tasks.asked_arms import arm_for, asked_arms
from vcage.tasks.choosing import moved_by
from vcage.tasks.pushing import HEADINGS
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.templates.proposal import Proposal


def require_possible(path: Path, field: str, subtask: Subtask, scene: Scene, objects: Sequence[SceneObject]) -> None:
    """Refuse a sub-task that names what the scene, its assets or the robot do not have. Motions are not tried here.

    Args:
        path: the file that it was read from.
        field: where it is there.
        subtask: what it says.
        scene: of the run.
        objects: of the scene.

    Raises:
        InputFileError: an object, arm, contact or functional point that there is not, or a part beyond its range.
    """
    by_id, arms = {o.id: o for o in objects}, load_robot(scene.robot).arms
    for name, value, known in _names(subtask, by_id, arms):
        if value is not None and value not in known:
            refuse(path, f"{field}.{name}", repr(value), near_names(value, known))
    for name, number, points in _points(subtask, by_id):
        if number not in points:
            refuse(path, f"{field}.{name}", str(number), f"one of {list(points)}")
    for name, goal in _goals(subtask):
        if unknown := unknown_name(goal, by_id, arms):
            refuse(path, f"{field}.{name}", f"there is no {unknown}", all_names(objects))
    _require_arm(path, field, subtask, scene)
    _require_choices(path, field, subtask, by_id)
    _require_offered(path, field, subtask, scene, objects)


def _names(
    subtask: Subtask, objects: Collection[str], arms: Collection[str]
) -> Iterator[tuple[str, str | None, Collection[str]]]:
    """Every field that names an object or an arm, what it says, and what it may say."""
    for name in ("object", "tool", "grasped"):
        yield name, getattr(subtask, name), objects
    yield "receptacle", subtask.receptacle, {*objects, TABLE}
    for name in ("arm", "hand_to"):
        yield name, getattr(subtask, name), arms
    for number, grasp in enumerate(subtask.grasps):
        yield f"grasps.{number}.arm", grasp.arm, arms


def _points(subtask: Subtask, objects: Mapping[str, SceneObject]) -> Iterator[tuple[str, int, Sequence[int]]]:
    """Every field that says a point of an object, its number, and those that the object has."""
    held = objects[subtask.grasped or subtask.object].asset.annotation
    contacts = range(len(HEADINGS)) if subtask.template == "push" else [point.id for point in held.contact_points]
    for number, grasp in enumerate(subtask.grasps):
        yield f"grasps.{number}.contact", grasp.contact, contacts
    if subtask.functional_point is not None:
        holder = objects.get(subtask.receptacle or "")
        places = [point.id for point in holder.asset.annotation.functional_points] if holder else []
        yield "functional_point", subtask.functional_point, places


def _goals(subtask: Subtask) -> Iterator[tuple[str, Goal]]:
    """Every field that holds a goal."""
    for name in ("goals", "requires"):
        yield from ((f"{name}.{number}", goal) for number, goal in enumerate(getattr(subtask, name)))


def _require_arm(path: Path, field: str, subtask: Subtask, scene: Scene) -> None:
    """Refuse another arm than the one that the instruction asks for."""
    asked, why = arm_for(subtask.goals, asked_arms(scene.goals), subtask.hand_to)
    if why is not None:
        refuse(path, f"{field}.goals", why, "goals that one arm is asked to bring about")
    if asked is not None and subtask.arm != asked:
        refuse(path, f"{field}.arm", repr(subtask.arm), f"{asked!r}, as the instruction asks")
    if subtask.arm is not None and subtask.hand_to == subtask.arm:
        refuse(path, f"{field}.hand_to", repr(subtask.hand_to), "another arm than the one that gives it")
    for number, grasp in enumerate(subtask.grasps):
        if subtask.arm is not None and grasp.arm != subtask.arm:
            refuse(path, f"{field}.grasps.{number}.arm", repr(grasp.arm), f"{subtask.arm!r}, the arm of the sub-task")


def _require_choices(path: Path, field: str, subtask: Subtask, objects: dict[str, SceneObject]) -> None:
    """Refuse a preferred grasp that is none of its grasps, and statements about what it moves."""
    grasps, prefers = [f"{g.contact} {g.arm}" for g in subtask.grasps], subtask.prefers
    if prefers is not None and f"{prefers.contact} {prefers.arm}" not in grasps:
        refuse(path, f"{field}.prefers", f"{prefers.contact} {prefers.arm}", f"one of its grasps: {', '.join(grasps)}")
    for number, statement in enumerate(subtask.statements):
        goal, where = statement.goal, f"{field}.statements.{number}"
        unknown = unknown_name(goal or Goal(subject=statement.subject, relation="back"), objects, ())
        if unknown:
            refuse(path, where, f"there is no {unknown}", all_names([*objects.values()]))
        if goal is None and statement.subject in moved_by(subtask):
            refuse(path, where, f"{statement.subject} is moved by the sub-task", "what it leaves where it is")


def _require_offered(path: Path, field: str, subtask: Subtask, scene: Scene, objects: Sequence[SceneObject]) -> None:
    """Refuse a sub-task that its template does not offer: with this object, this receptacle and these goals."""
    if subtask.receptacle == subtask.object:
        refuse(path, f"{field}.receptacle", repr(subtask.receptacle), "another than the object itself")
    if subtask.template == "hand_over" and subtask.hand_to is None:
        refuse(path, f"{field}.hand_to", "null", "the arm that it is handed to")
    offered = _offering(subtask, scene, objects)
    mine = [proposal for proposal in offered if subtask.template in proposal.templates]
    if not mine:
        _refuse_template(path, field, subtask, offered)
    refusals = [proposal.impossible() for proposal in mine]
    if all(refusals):
        refuse(path, field, str(refusals[0] and refusals[0].reason), "what is possible by size")


def _offering(subtask: Subtask, scene: Scene, objects: Sequence[SceneObject]) -> list[Proposal]:
    """All proposals of templates that a sub-task may be one of."""
    asked = {*subtask.goals, *(one.goal for one in scene.goals)}
    return [p for template in TEMPLATES.values() for p in template.proposals(objects, asked)[0] if p.offers(subtask)]


def _refuse_template(path: Path, field: str, subtask: Subtask, offered: Sequence[Proposal]) -> NoReturn:
    """Say that the template of a sub-task does not do that, and which others do."""
    goals = " and ".join(map(str, subtask.goals))
    names = dict.fromkeys(name for proposal in offered for name in proposal.templates)
    wanted = " or ".join(names) or f"what {subtask.template} can do in this scene"
    found = f"{subtask.template} does not do that with {subtask.object}: {goals}"
    refuse(path, f"{field}.template" if offered else field, found, wanted)
