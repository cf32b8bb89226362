"""Check that the scene of a file is possible: as strict as the stages are with their own."""

from __future__ import annotations

import difflib
import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain
from pathlib import Path

import numpy as np

from vcage.base.errors import UnknownName
from vcage.base.geometry import Pose
from vcage.models.checked_reading import Instructed
from vcage.models.registry import third_reader
from vcage.models.same_reading import contradictions
from vcage.plans.plain_words import in_words
from vcage.runs.context import StageContext
from vcage.runs.edits import Complaint, Edit, require_none
from vcage.schema.base import PoseRecord, box_record
from vcage.schema.goals import Goal, Reading
from vcage.schema.plan import TABLE
from vcage.schema.scene import ObjectRecord, Scene
from vcage.sim.bodies import Body
from vcage.sim.collision import SETTINGS as COLLISION
from vcage.sim.collision import overlapping
from vcage.sim.robots import load_robot, load_template
from vcage.sim.state import SettleReport
from vcage.sim.world import World
from vcage.tasks.described import untrue
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import resting_point


@dataclass(frozen=True)
class StabilityLimits:
    """The largest settling motion of an object that stays in place, and of a ball that stays in its heap."""

    drift_m: float = 0.005
    tilt_rad: float = math.radians(4)
    heaped_m: float = 0.04


STABILITY = StabilityLimits()


def moved_objects(report: SettleReport, objects: Iterable[ObjectRecord]) -> list[str]:
    """Ids of the objects that did not stay where they were put, and of balls that left their heap.

    Args:
        report: of settling.
        objects: of the scene.
    """
    heaped = {o.id for o in objects if o.heaped}
    return [
        name
        for name, drift in report.drift_m.items()
        if (
            drift > STABILITY.heaped_m
            if name in heaped
            else drift > STABILITY.drift_m or report.tilt_rad[name] > STABILITY.tilt_rad
        )
    ]


def settle_checks(report: SettleReport) -> dict[str, float]:
    """Steps and largest motion of settling, for the checks of a scene."""
    return {
        "settle_steps": report.steps,
        "largest_drift_mm": round(1000 * max(report.drift_m.values()), 3),
        "largest_tilt_deg": round(float(np.degrees(max(report.tilt_rad.values()))), 3),
    }


ROUNDING_M = 1e-6
"""Metres (or radians) by which a joint may be outside its range, and an object beyond the table's edge."""

SCENE_FIELDS = ("objects", "goals", "descriptions", "untouched", "robot", "checks")
"""Fields of a scene that may be edited: all else it has from its instruction and template, or is drawn of it."""


def accepted_scene(edit: Edit[Scene]) -> Scene:
    """Return an edited scene as it settles, checked as :func:`possible_scene` does.

    Raises:
        InputFileError: it is impossible, or its goals or descriptions contradict the instruction.
    """
    found = possible_scene(edit.path, edit.record, edit.context)
    require_none(edit.path, _reading_complaints(edit))
    return found


def _reading_complaints(edit: Edit[Scene]) -> Iterator[Complaint]:
    """Complaints about edited goals and descriptions, by the check of a reading."""
    scene, edited = edit.record, edit.changes("goals", "descriptions", "untouched")
    if not edited or scene.instruction is None:
        return
    if not scene.goals:
        yield "goals", "none", f"those of the instruction {scene.instruction!r}"
    reading = Reading(goals=scene.goals, descriptions=scene.descriptions, untouched=scene.untouched)
    things = {o.id: o.kind() for o in edit.context.objects(scene)}
    moved = [o.id for o in scene.objects if o.role == "content"]
    lying = {o.id: o.container for o in scene.objects if o.container is not None}
    asked = Instructed(scene.instruction, things, lying, moved)
    if found := contradictions(asked, reading, third_reader()):
        yield edited[0], "; ".join(found), f"what the instruction says: {scene.instruction!r}"


def possible_scene(path: Path, scene: Scene, context: StageContext) -> Scene:
    """The scene as it settles in the simulator, with checked boxes.

    Args:
        path: the file that it was read from.
        scene: the edited one.
        context: the library.

    Raises:
        InputFileError: an unknown asset, robot or object; a part beyond its range; objects that overlap, are
            not on the table, do not stay where they are put, or lie in other things than is said. Names the file, the
            field, and the expected value.
    """
    require_none(path, _unknown(scene, context))
    objects = context.objects(scene)
    require_none(path, chain(_wrong_joints(objects), _wrong_goals(scene, objects), _misplaced(scene, objects)))
    world = World.of_scene(scene, context.physical_models(scene))
    report = world.settle()
    require_none(path, _unsettled(report, scene.objects))
    records = [settled_record(o, world.object_pose(o.id), context) for o in scene.objects]
    settled = scene.model_copy(update={"objects": records, "checks": settle_checks(report)})
    lying = context.objects(settled)
    require_none(path, chain(_wrong_containers(lying), _wrong_descriptions(settled, lying)))
    return settled


def _unsettled(report: SettleReport, objects: Sequence[ObjectRecord]) -> Iterator[Complaint]:
    ids = [o.id for o in objects]
    for name in [*moved_objects(report, objects), *report.fallen]:
        drift, tilt = 1000 * report.drift_m[name], np.degrees(report.tilt_rad[name])
        yield (
            f"objects.{ids.index(name)}.pose",
            f"{name} does not stay there: it moves by {drift:.0f} mm and {tilt:.0f}° when it is let go",
            f"a pose in which it moves by less than {1000 * STABILITY.drift_m:.0f} mm and "
            f"{np.degrees(STABILITY.tilt_rad):.0f}°",
        )
    if not report.settled:
        yield "objects", "they do not come to rest", "poses in which they do"


def settled_record(o: ObjectRecord, pose: Pose, context: StageContext) -> ObjectRecord:
    """An object at another pose, with its box there."""
    return o.model_copy(update={"pose": PoseRecord.of(pose), "aabb": box_record(context.asset(o).bounds, pose)})


def _unknown(scene: Scene, context: StageContext) -> Iterator[Complaint]:
    """Complaints about an unknown template, robot, asset or variant."""
    lookups = [("template", partial(load_template, scene.template)), ("robot", partial(load_robot, scene.robot))]
    lookups += [(f"objects.{number}.", partial(context.asset, o)) for number, o in enumerate(scene.objects)]
    for field, look_up in lookups:
        try:
            look_up()
        except UnknownName as error:
            name, known, what = (error.details[key] for key in ("name", "available", "what"))
            part = ("asset" if what == "asset" else "variant") if field.endswith(".") else ""
            yield f"{field}{part}", repr(name), near_names(name, known)


def _wrong_joints(objects: Sequence[SceneObject]) -> Iterator[Complaint]:
    for number, o in enumerate(objects):
        links, field = o.asset.model.links, f"objects.{number}.joints"
        if o.joints and len(o.joints) != len(links):
            yield field, f"{len(o.joints)} positions", f"{len(links)}, one for each part"
        for link, position in zip(links, o.joints, strict=False):
            lower, upper = link.joint.lower, link.joint.upper
            if not lower - ROUNDING_M <= position <= upper + ROUNDING_M:
                yield field, f"{position:g}", f"one from {lower:g} to {upper:g} of its {link.name}"


def _wrong_goals(scene: Scene, objects: Sequence[SceneObject]) -> Iterator[Complaint]:
    """Complaints about goals, and objects to be left alone, with unknown objects or other words."""
    by_id, arms = {o.id: o for o in objects}, load_robot(scene.robot).arms
    for number, asked in enumerate(scene.goals):
        goal, field = asked.goal, f"goals.{number}"
        if unknown := unknown_name(goal, by_id, arms):
            yield f"{field}.goal", f"there is no {unknown}", all_names(objects)
        if goal.subject == goal.reference or goal.subject in scene.untouched:
            yield f"{field}.goal.subject", repr(goal.subject), "not its own reference, nor what is left alone"
        yield from _unknown_name(f"{field}.goal.reference", goal.reference, _places(goal, by_id, arms))
        yield from _unknown_name(f"{field}.arm", asked.arm, arms)
        yield from _other_words(field, asked.words, scene)
    for number, name in enumerate(scene.untouched):
        yield from _unknown_name(f"untouched.{number}", name, by_id)


def _places(goal: Goal, objects: Collection[str], arms: Collection[str]) -> Collection[str]:
    """Names that a goal may refer to."""
    if goal.kind.refers_to == "arm":
        return arms
    return objects if goal.relation == "inside" else {*objects, TABLE}


def _unknown_name(field: str, name: str | None, known: Collection[str]) -> Iterator[Complaint]:
    if name is not None and name not in known:
        yield field, repr(name), near_names(name, known)


def _other_words(field: str, words: str, scene: Scene) -> Iterator[Complaint]:
    if words not in (scene.instruction or ""):
        yield f"{field}.words", repr(words), f"words of the instruction {scene.instruction!r}"


def _misplaced(scene: Scene, objects: Sequence[SceneObject]) -> Iterator[Complaint]:
    """Complaints about objects beyond the table's edge, and about overlapping ones."""
    lower, upper = scene.table.rectangle
    fields = {o.id: f"objects.{number}.pose" for number, o in enumerate(objects)}
    for o in objects:
        low, high = o.aabb[:, :2]
        beyond = float(np.max([lower - low, high - upper]))
        if beyond > ROUNDING_M:
            wanted = f"all of it from {tuple(lower.tolist())} to {tuple(upper.tolist())}"
            yield fields[o.id], f"{o.id} reaches {100 * beyond:.1f} cm beyond the table's edge", wanted
    for first, second in overlapping({o.id: Body(o.asset.model, o.pose, o.joints) for o in objects}):
        found = f"{second} overlaps {first} by more than {1000 * COLLISION.overlap_m:.0f} mm"
        yield fields[second], found, "a pose that is free"


def _wrong_containers(objects: Sequence[SceneObject]) -> Iterator[Complaint]:
    """Complaints about a ``container`` that an object does not lie in or on: goals and plans start from it."""
    for number, o in enumerate(objects):
        points = {other.id: resting_point(o, other) for other in objects if other is not o}
        bearers = {name: point for name, point in points.items() if point is not None}
        named, field = o.record.container, f"objects.{number}"
        if named not in ([*bearers] or [None]):
            found = f"{named!r}, but {o.id} lies in or on {' or '.join(bearers) or 'no object'}"
            yield f"{field}.container", found, " or ".join(map(repr, bearers)) or "null"
        part = None if named is None else bearers[named].link
        if o.record.container_part != part:
            yield f"{field}.container_part", repr(o.record.container_part), repr(part or "null")


def _wrong_descriptions(scene: Scene, objects: Sequence[SceneObject]) -> Iterator[Complaint]:
    """Complaints about descriptions with unknown objects, in other words than the instruction's, or untrue."""
    by_id = {o.id: o for o in objects}
    for number, d in enumerate(scene.descriptions):
        field = f"descriptions.{number}"
        for name, known in ((d.subject, by_id), (d.reference, {*by_id, TABLE})):
            if name not in known:
                yield field, f"there is no {name}", all_names(objects)
        if d.part is not None and d.part not in {link.name for link in by_id[d.reference].asset.model.links}:
            yield f"{field}.part", repr(d.part), all_names(objects)
        yield from _other_words(field, d.words, scene)
    for d in untrue(scene, objects):
        wanted = f"poses in which {in_words(d, {o.id: o.phrase for o in scene.objects})}"
        yield f"descriptions.{scene.descriptions.index(d)}", "it is not true where the objects stand", wanted


# --- names ------------------------------------------------------------------------------------------------


def near_names(name: str, known: Collection[str]) -> str:
    """Known names that are like an unknown one; some of all where none is."""
    near = difflib.get_close_matches(name, known, n=3) or sorted(known)[:12]
    return f"{', '.join(near)}{' or another of those that there are' if len(near) < len(known) else ''}"


def all_names(objects: Sequence[SceneObject]) -> str:
    """Objects and parts that goals may be about, for an error."""
    parts = [f"{o.id}/{part}" for o in objects for part in o.asset.entry().parts]
    return f"what there is: {', '.join([*(o.id for o in objects), *parts])}"


def unknown_name(goal: Goal, objects: Mapping[str, SceneObject], arms: Collection[str]) -> str | None:
    """The first thing or part that a goal names and the scene does not have; None where it has all."""
    if goal.subject not in objects:
        return goal.subject
    if goal.reference is not None and goal.reference not in {*objects, TABLE, *arms}:
        return goal.reference
    owner = objects.get(goal.reference or "", objects[goal.subject])
    parts = {part for thing in (owner, objects[goal.subject]) for part in thing.asset.entry().parts}
    return goal.part if goal.part is not None and goal.part not in parts else None
