"""Whether a scene that was written or edited by hand is possible: as strict as the stages are with their own."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Sequence
from pathlib import Path

import numpy as np

from vcage.base.errors import UnknownName
from vcage.base.geometry import Pose
from vcage.plans.plain_words import in_words
from vcage.schema.base import PoseRecord, box_record
from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE
from vcage.schema.scene import ObjectRecord, Scene
from vcage.schema.subtasks import Subtask
from vcage.sim.bodies import Body
from vcage.sim.collision import TOLERANCE, overlapping
from vcage.sim.robots import load_robot, load_template
from vcage.sim.world import World
from vcage.stages.context import StageContext
from vcage.stages.edits import refuse, require_same, written_record
from vcage.stages.stability import MAX_DRIFT, MAX_TILT, moved_objects, settle_checks
from vcage.tasks.asked_arms import arm_for, asked_arms
from vcage.tasks.choosing import moved_by
from vcage.tasks.described import untrue
from vcage.tasks.pushing import HEADINGS
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.truth import resting_point

ROUNDING = 1e-6
"""Metres by which a joint may be outside its range, and an object beyond the table's edge."""


GIVEN = ("instruction", "template", "table", "workspace", "top_camera", "pictures", "segmentation_ids")
"""What a scene has from its instruction and its template, and what is drawn of it: not to be edited."""


def edited_scene(path: Path, context: StageContext) -> Scene:
    """The scene of a file that was edited by hand, as it settles.

    Args:
        path: its file.
        context: the library.

    Raises:
        InputFileError: it is not possible, see :func:`possible_scene`; or it is another place or instruction than
            before, or has no goals any more.
    """
    require_same(path, *GIVEN)
    scene = Scene.read(path)
    if written_record(path, Scene).goals and not scene.goals:
        refuse(path, "goals", "none", f"those of the instruction {scene.instruction!r}")
    return possible_scene(path, scene, context)


def possible_scene(path: Path, scene: Scene, context: StageContext) -> Scene:
    """The scene as it settles in the simulator, with boxes and checks of that.

    Args:
        path: the file that it was read from.
        scene: what it says.
        context: the library.

    Raises:
        InputFileError: an asset, robot or object that there is not; a part beyond its range; objects that overlap, are
            not on the table, do not stay where they are put, or lie in other things than is said. Names the file, the
            field, and what was expected.
    """
    _require_known(path, scene, context)
    objects = context.objects(scene)
    _require_joints(path, objects)
    _require_goals(path, scene, objects)
    _require_on_table(path, scene, objects)
    numbers = {o.id: number for number, o in enumerate(objects)}
    for first, second in overlapping({o.id: Body(o.asset.model, o.pose, o.joints) for o in objects}):
        refuse(
            path,
            f"objects.{numbers[second]}.pose",
            f"{second} overlaps {first} by more than {1000 * TOLERANCE:.0f} mm",
            "a pose that is free",
        )
    world = World.of_scene(scene, context.physical_models(scene))
    report = world.settle()
    for name in [*moved_objects(report), *report.fallen]:
        drift, tilt = 1000 * report.drift_m[name], np.degrees(report.tilt_rad[name])
        refuse(
            path,
            f"objects.{numbers[name]}.pose",
            f"{name} does not stay there: it moves by {drift:.0f} mm and {tilt:.0f}° when it is let go",
            f"a pose in which it moves by less than {1000 * MAX_DRIFT:.0f} mm and {np.degrees(MAX_TILT):.0f}°",
        )
    if not report.settled:
        refuse(path, "objects", "they do not come to rest", "poses in which they do")
    poses = world.object_poses()
    records = [settled_record(o, poses[o.id], context) for o in scene.objects]
    settled = scene.model_copy(update={"objects": records, "checks": settle_checks(report)})
    _require_containers(path, context.objects(settled))
    _require_descriptions(path, settled, context.objects(settled))
    return settled


def settled_record(o: ObjectRecord, pose: Pose, context: StageContext) -> ObjectRecord:
    """An object at another pose, with the box that it has there."""
    return o.model_copy(update={"pose": PoseRecord.of(pose), "aabb": box_record(context.asset(o).bounds, pose)})


def _require_known(path: Path, scene: Scene, context: StageContext) -> None:
    """That there are the template, the robot, and every asset and variant."""
    try:
        load_template(scene.template)
    except UnknownName as error:
        refuse(path, "template", repr(scene.template), _one_of(scene.template, error.details["available"]))
    try:
        load_robot(scene.robot)
    except UnknownName as error:
        refuse(path, "robot", repr(scene.robot), _one_of(scene.robot, error.details["available"]))
    for number, o in enumerate(scene.objects):
        try:
            context.asset(o)
        except UnknownName as error:
            name, known = error.details["name"], error.details["available"]
            field = "asset" if error.details["what"] == "asset" else "variant"
            refuse(path, f"objects.{number}.{field}", repr(name), _one_of(name, known))


def _one_of(name: str, known: Collection[str]) -> str:
    near = difflib.get_close_matches(name, known, n=3) or sorted(known)[:12]
    return f"{', '.join(near)}{' or another of those that there are' if len(near) < len(known) else ''}"


def _all_of(objects: Sequence[SceneObject]) -> str:
    """What goals may be about."""
    parts = [f"{o.id}/{link.name}" for o in objects for link in o.asset.model.links]
    return f"what there is: {', '.join([*(o.id for o in objects), *parts])}"


def _require_joints(path: Path, objects: Sequence[SceneObject]) -> None:
    for number, o in enumerate(objects):
        links = o.asset.model.links
        if o.joints and len(o.joints) != len(links):
            refuse(path, f"objects.{number}.joints", f"{len(o.joints)} positions", f"{len(links)}, one for each part")
        for link, position in zip(links, o.joints, strict=False):
            lower, upper = link.joint.lower, link.joint.upper
            if not lower - ROUNDING <= position <= upper + ROUNDING:
                range_of = f"one from {lower:g} to {upper:g} of its {link.name}"
                refuse(path, f"objects.{number}.joints", f"{position:g}", range_of)


def _require_goals(path: Path, scene: Scene, objects: Sequence[SceneObject]) -> None:
    """That goals, and what is to be left alone, are about what there is, and goals are what the instruction asks."""
    by_id, arms = {o.id: o for o in objects}, load_robot(scene.robot).arms
    for number, asked in enumerate(scene.goals):
        goal, field = asked.goal, f"goals.{number}.goal"
        unknown = strangers(goal, by_id, arms)
        if unknown:
            refuse(path, field, f"there is no {unknown}", _all_of(objects))
        if goal.subject == goal.reference or goal.subject in scene.untouched:
            refuse(path, f"{field}.subject", repr(goal.subject), "not its own reference, nor what is left alone")
        places = arms if goal.relation == "handed" else [*by_id, *([] if goal.relation == "inside" else [TABLE])]
        if goal.reference is not None and goal.reference not in places:
            refuse(path, f"{field}.reference", repr(goal.reference), _one_of(goal.reference, places))
        if asked.arm is not None and asked.arm not in arms:
            refuse(path, f"goals.{number}.arm", repr(asked.arm), _one_of(asked.arm, arms))
        if asked.words not in (scene.instruction or ""):
            refuse(path, f"goals.{number}.words", repr(asked.words), f"words of the instruction {scene.instruction!r}")
    for number, name in enumerate(scene.untouched):
        if name not in by_id:
            refuse(path, f"untouched.{number}", repr(name), _one_of(name, by_id))


def strangers(goal: Goal, objects: dict[str, SceneObject], arms: Collection[str]) -> str | None:
    """The first thing or part that a goal names and the scene does not have; None where it has all."""
    if goal.subject not in objects:
        return goal.subject
    if goal.reference is not None and goal.reference not in {*objects, TABLE, *arms}:
        return goal.reference
    owner = objects.get(goal.reference or "", objects[goal.subject])
    parts = {link.name for thing in (owner, objects[goal.subject]) for link in thing.asset.model.links}
    return goal.part if goal.part is not None and goal.part not in parts else None


def _require_on_table(path: Path, scene: Scene, objects: Sequence[SceneObject]) -> None:
    lower, upper = scene.table.rectangle
    for number, o in enumerate(objects):
        low, high = o.aabb[:, :2]
        beyond = float(np.max([lower - low, high - upper]))
        if beyond > ROUNDING:
            refuse(
                path,
                f"objects.{number}.pose",
                f"{o.id} reaches {100 * beyond:.1f} cm beyond the table's edge",
                f"all of it from {tuple(lower.tolist())} to {tuple(upper.tolist())}",
            )


def _require_containers(path: Path, objects: Sequence[SceneObject]) -> None:
    """That ``container`` names what each object lies in or on, which is what goals and plans start from."""
    for number, o in enumerate(objects):
        bearers = [other.id for other in objects if other is not o and resting_point(o, other) is not None]
        named = o.record.container
        if (named is None and bearers) or (named is not None and named not in bearers):
            found = f"{named!r}, but {o.id} lies in or on {' or '.join(bearers) or 'no object'}"
            refuse(path, f"objects.{number}.container", found, " or ".join(map(repr, bearers)) or "null")
        point = next((resting_point(o, other) for other in objects if other.id == named), None)
        part = None if point is None else point.link
        if o.record.container_part != part:
            refuse(path, f"objects.{number}.container_part", repr(o.record.container_part), repr(part or "null"))


def _require_descriptions(path: Path, scene: Scene, objects: Sequence[SceneObject]) -> None:
    """That descriptions are about what there is and in the instruction's words, and that each is true."""
    by_id = {o.id: o for o in objects}
    for number, d in enumerate(scene.descriptions):
        field = f"descriptions.{number}"
        for name, known in ((d.subject, by_id), (d.reference, [*by_id, TABLE])):
            if name not in known:
                refuse(path, field, f"there is no {name}", _all_of(objects))
        if d.part is not None and d.part not in {link.name for link in by_id[d.reference].asset.model.links}:
            refuse(path, f"{field}.part", repr(d.part), _all_of(objects))
        if d.words not in (scene.instruction or ""):
            refuse(path, f"{field}.words", repr(d.words), f"words of the instruction {scene.instruction!r}")
    for d in untrue(scene, objects):
        wanted = f"poses in which {in_words(d, {o.id: o.phrase for o in scene.objects})}"
        refuse(path, f"descriptions.{scene.descriptions.index(d)}", "it is not true where the objects stand", wanted)


def require_possible(path: Path, field: str, subtask: Subtask, scene: Scene, objects: Sequence[SceneObject]) -> None:
    """That a sub-task is about what the scene, its assets and the robot have. Whether it is feasible is tried out.

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
    for name in ("object", "receptacle", "tool", "grasped"):
        value, known = getattr(subtask, name), {*by_id, *([TABLE] if name == "receptacle" else [])}
        if value is not None and value not in known:
            refuse(path, f"{field}.{name}", repr(value), _one_of(value, known))
    if subtask.hand_to is not None and subtask.hand_to not in arms:
        refuse(path, f"{field}.hand_to", repr(subtask.hand_to), _one_of(subtask.hand_to, arms))
    _require_arm(path, field, subtask, scene, arms)
    held = by_id[subtask.grasped or subtask.object].asset.annotation
    contacts = range(len(HEADINGS)) if subtask.template == "push" else [point.id for point in held.contact_points]
    for number, grasp in enumerate(subtask.grasps):
        if grasp.arm not in arms:
            refuse(path, f"{field}.grasps.{number}.arm", repr(grasp.arm), _one_of(grasp.arm, arms))
        if grasp.contact not in contacts:
            refuse(path, f"{field}.grasps.{number}.contact", str(grasp.contact), f"one of {list(contacts)}")
    if subtask.functional_point is not None:
        holder = by_id.get(subtask.receptacle or "")
        places = [point.id for point in holder.asset.annotation.functional_points] if holder else []
        if subtask.functional_point not in places:
            refuse(path, f"{field}.functional_point", str(subtask.functional_point), f"one of {places}")
    for what in ("goals", "requires"):
        for number, goal in enumerate(getattr(subtask, what)):
            unknown = strangers(goal, by_id, arms)
            if unknown:
                refuse(path, f"{field}.{what}.{number}", f"there is no {unknown}", _all_of(objects))
    _require_choices(path, field, subtask, by_id)
    _require_offered(path, field, subtask, scene, objects)


def _require_arm(path: Path, field: str, subtask: Subtask, scene: Scene, arms: Collection[str]) -> None:
    """That it is done by the arm that the instruction asks for, if it asks for one, and by no other."""
    if subtask.arm is not None and subtask.arm not in arms:
        refuse(path, f"{field}.arm", repr(subtask.arm), _one_of(subtask.arm, arms))
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
    """That the preferred grasp is one of its grasps, and that what is to stay as it was can."""
    grasps, prefers = [f"{g.contact} {g.arm}" for g in subtask.grasps], subtask.prefers
    if prefers is not None and f"{prefers.contact} {prefers.arm}" not in grasps:
        refuse(path, f"{field}.prefers", f"{prefers.contact} {prefers.arm}", f"one of its grasps: {', '.join(grasps)}")
    for number, statement in enumerate(subtask.statements):
        goal, where = statement.goal, f"{field}.statements.{number}"
        unknown = strangers(goal or Goal(subject=statement.subject, relation="back"), objects, ())
        if unknown:
            refuse(path, where, f"there is no {unknown}", _all_of([*objects.values()]))
        if goal is None and statement.subject in moved_by(subtask):
            refuse(path, where, f"{statement.subject} is moved by the sub-task", "what it leaves where it is")


def _require_offered(path: Path, field: str, subtask: Subtask, scene: Scene, objects: Sequence[SceneObject]) -> None:
    """That its template, looked for anew, offers just this: its object, where that goes, and what it brings about."""
    if subtask.receptacle == subtask.object:
        refuse(path, f"{field}.receptacle", repr(subtask.receptacle), "another than the object itself")
    if subtask.template == "hand_over" and subtask.hand_to is None:
        refuse(path, f"{field}.hand_to", "null", "the arm that it is handed to")
    asked = {*subtask.goals, *(one.goal for one in scene.goals)}
    offered = [p for template in TEMPLATES.values() for p in template.proposals(objects, asked)[0] if p.offers(subtask)]
    mine = [proposal for proposal in offered if subtask.template in proposal.templates]
    if not mine:
        goals = " and ".join(map(str, subtask.goals))
        names = dict.fromkeys(name for proposal in offered for name in proposal.templates)
        wanted = " or ".join(names) or f"what {subtask.template} can do in this scene"
        found = f"{subtask.template} does not do that with {subtask.object}: {goals}"
        refuse(path, f"{field}.template" if offered else field, found, wanted)
    refusals = [proposal.impossible() for proposal in mine]
    if all(refusals):
        refuse(path, field, str(refusals[0] and refusals[0].reason), "what is possible by size")
