"""Whether a scene that was written or edited by hand is possible: as strict as the stages are with their own."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path

import numpy as np

from vcage.base.errors import UnknownName
from vcage.base.geometry import Pose
from vcage.models.registry import third_reader
from vcage.models.same_reading import contradictions
from vcage.plans.plain_words import in_words
from vcage.runs.context import StageContext
from vcage.runs.edits import refuse, require_same, written_record
from vcage.scenes.known_names import all_names, near_names, unknown_name
from vcage.scenes.stability import STABILITY, moved_objects, settle_checks
from vcage.schema.asset import FunctionalPoint
from vcage.schema.base import PoseRecord, box_record
from vcage.schema.goals import Goal, Reading
from vcage.schema.plan import TABLE
from vcage.schema.scene import ObjectRecord, Scene
from vcage.sim.bodies import Body
from vcage.sim.collision import TOLERANCE, overlapping
from vcage.sim.robots import load_robot, load_template
from vcage.sim.world import World
from vcage.tasks.described import untrue
from vcage.tasks.scene_objects import SceneObject
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
    found = possible_scene(path, scene, context)
    _require_instructed(path, scene, context)
    return found


def _require_instructed(path: Path, scene: Scene, context: StageContext) -> None:
    """Refuse edited goals and descriptions that are not what the instruction says."""
    before = written_record(path, Scene)
    edited = [
        field for field in ("goals", "descriptions", "untouched") if getattr(scene, field) != getattr(before, field)
    ]
    if not edited or scene.instruction is None:
        return
    reading = Reading(goals=scene.goals, descriptions=scene.descriptions, untouched=scene.untouched)
    things = {o.id: o.kind() for o in context.objects(scene)}
    moved = [o.id for o in scene.objects if o.role == "content"]
    lying = {o.id: o.container for o in scene.objects if o.container is not None}
    if found := contradictions(scene.instruction, things, reading, moved, lying, third_reader()):
        refuse(path, edited[0], "; ".join(found), f"what the instruction says: {scene.instruction!r}")


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
            f"a pose in which it moves by less than {1000 * STABILITY.drift_m:.0f} mm and "
            f"{np.degrees(STABILITY.tilt_rad):.0f}°",
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
        refuse(path, "template", repr(scene.template), near_names(scene.template, error.details["available"]))
    try:
        load_robot(scene.robot)
    except UnknownName as error:
        refuse(path, "robot", repr(scene.robot), near_names(scene.robot, error.details["available"]))
    for number, o in enumerate(scene.objects):
        try:
            context.asset(o)
        except UnknownName as error:
            name, known = error.details["name"], error.details["available"]
            field = "asset" if error.details["what"] == "asset" else "variant"
            refuse(path, f"objects.{number}.{field}", repr(name), near_names(name, known))


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
        goal, field = asked.goal, f"goals.{number}"
        if unknown := unknown_name(goal, by_id, arms):
            refuse(path, f"{field}.goal", f"there is no {unknown}", all_names(objects))
        if goal.subject == goal.reference or goal.subject in scene.untouched:
            refuse(path, f"{field}.goal.subject", repr(goal.subject), "not its own reference, nor what is left alone")
        _require_name(path, f"{field}.goal.reference", goal.reference, _places(goal, by_id, arms))
        _require_name(path, f"{field}.arm", asked.arm, arms)
        _require_words(path, field, asked.words, scene)
    for number, name in enumerate(scene.untouched):
        _require_name(path, f"untouched.{number}", name, by_id)


def _places(goal: Goal, objects: Collection[str], arms: Collection[str]) -> Collection[str]:
    """Names that a goal may refer to."""
    if goal.relation == "handed":
        return arms
    return objects if goal.relation == "inside" else {*objects, TABLE}


def _require_name(path: Path, field: str, name: str | None, known: Collection[str]) -> None:
    if name is not None and name not in known:
        refuse(path, field, repr(name), near_names(name, known))


def _require_words(path: Path, field: str, words: str, scene: Scene) -> None:
    if words not in (scene.instruction or ""):
        refuse(path, f"{field}.words", repr(words), f"words of the instruction {scene.instruction!r}")


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
        bearers, named = _bearers(o, objects), o.record.container
        if named not in ([*bearers] or [None]):
            found = f"{named!r}, but {o.id} lies in or on {' or '.join(bearers) or 'no object'}"
            refuse(path, f"objects.{number}.container", found, " or ".join(map(repr, bearers)) or "null")
        part = None if named is None else bearers[named].link
        if o.record.container_part != part:
            refuse(path, f"objects.{number}.container_part", repr(o.record.container_part), repr(part or "null"))


def _bearers(o: SceneObject, objects: Sequence[SceneObject]) -> dict[str, FunctionalPoint]:
    """The functional points that an object rests at, by the id of what has them."""
    points = {other.id: resting_point(o, other) for other in objects if other is not o}
    return {name: point for name, point in points.items() if point is not None}


def _require_descriptions(path: Path, scene: Scene, objects: Sequence[SceneObject]) -> None:
    """That descriptions are about what there is and in the instruction's words, and that each is true."""
    by_id = {o.id: o for o in objects}
    for number, d in enumerate(scene.descriptions):
        field = f"descriptions.{number}"
        for name, known in ((d.subject, by_id), (d.reference, [*by_id, TABLE])):
            if name not in known:
                refuse(path, field, f"there is no {name}", all_names(objects))
        if d.part is not None and d.part not in {link.name for link in by_id[d.reference].asset.model.links}:
            refuse(path, f"{field}.part", repr(d.part), all_names(objects))
        _require_words(path, field, d.words, scene)
    for d in untrue(scene, objects):
        wanted = f"poses in which {in_words(d, {o.id: o.phrase for o in scene.objects})}"
        refuse(path, f"descriptions.{scene.descriptions.index(d)}", "it is not true where the objects stand", wanted)
