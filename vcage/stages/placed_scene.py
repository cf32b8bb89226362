"""Placing chosen objects on the table: placements are drawn until one stays put, and its pictures are taken."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.base.pictures import write_labels, write_picture
from vcage.layout.capacities import opening_for
from vcage.layout.items import Placement, TableItem, table_item
from vcage.layout.placement.place import place
from vcage.layout.placement.view import view_rectangles
from vcage.models.selection_check import NamedObject
from vcage.objects.asset import Asset
from vcage.objects.openings import Opening
from vcage.plans.actions import open_at_start
from vcage.plans.descriptions import described_relations
from vcage.plans.plain_words import in_words
from vcage.schema.base import PoseRecord, box_record
from vcage.schema.goals import Description, Goal, in_steps
from vcage.schema.plan import TABLE
from vcage.schema.robot import Robot
from vcage.schema.scene import ObjectRecord, Scene, SceneTemplate
from vcage.sim.cameras import observe, shoot
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.stages.context import StageContext
from vcage.stages.stability import moved_objects, settle_checks
from vcage.tasks.described import complaints
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.stowing import stow

MARGIN = 0.015
"""Smallest gap between two objects, metres: wide enough for the picture to show the table between them."""

BORDER = 2.0
"""Pixels that stay free between an object and the edge of the top view."""

TRIES = 5
"""Placements that are drawn before a scene whose objects do not stay put is given up."""


def place_until_stable(
    fields: dict[str, Any],
    objects: list[NamedObject],
    template: SceneTemplate,
    context: StageContext,
    rng: np.random.Generator,
) -> Scene:
    """Draw placements until one stays put in the simulator; its settled poses are what M records.

    Args:
        fields: of the scene, but for objects and checks.
        objects: what is placed.
        template: of the scene.
        context: the library.
        rng: of the placements.

    Raises:
        InfeasibleScene: the objects have no place, or do not stay where they are put.
    """
    descriptions: Sequence[Description] = fields.get("descriptions", ())
    items = _place_items([o for o in objects if o.starts_in_part is None], template, context)
    height = template.table.height
    joints = _joints(objects, in_steps(fields.get("goals", ())), context)
    worst: list[str] = []
    false: list[str] = []
    for attempt in range(1, TRIES + 1):
        spots = _spots(items, template, rng, descriptions, {o.id: o.phrase for o in objects})
        poses = {item.id: item.pose(spots[item.id], height + spots[item.id].z) for item in items}
        poses |= _stowed(objects, poses, context, load_robot(template.robot), rng)
        scene = Scene(**fields, objects=[_record(o, poses[o.id], context, joints[o.id]) for o in objects])
        world = World.of_scene(scene, context.physical_models(scene))
        report = world.settle()
        worst = moved_objects(report)
        if report.settled and not worst:
            poses = world.object_poses()
            checks = {**settle_checks(report), "placements": attempt}
            scene = Scene(
                **fields, objects=[_record(o, poses[o.id], context, joints[o.id]) for o in objects], checks=checks
            )
            false = complaints(scene, context.objects(scene))
            if not false:
                return scene
    if false and not worst:
        raise InfeasibleScene(
            f"in none of {TRIES} placements all of the instruction was true of the start: {'; '.join(false)}",
            hint="say it otherwise, or with fewer objects",
            details={"descriptions": false},
        )
    raise InfeasibleScene(
        f"{', '.join(worst) or 'the objects'} did not stay where they were put in {TRIES} placements",
        hint="check their collision hulls, or leave them out",
        details={"objects": worst},
    )


def _spots(
    items: Sequence[TableItem],
    template: SceneTemplate,
    rng: np.random.Generator,
    descriptions: Sequence[Description],
    phrases: Mapping[str, str],
) -> dict[str, Placement]:
    """A place for every item, such that what is described of it is true.

    Raises:
        InfeasibleScene: there is none; names what is described where the items have places without that.
    """
    workspace = np.array([template.workspace.lower, template.workspace.upper])
    known = {TABLE, *(item.id for item in items)}
    relations = [r for r in described_relations(descriptions) if {r.subject, r.reference} <= known]
    try:
        return place(items, workspace, rng, margin=MARGIN, relations=relations)
    except InfeasibleScene as error:
        if not relations:
            raise
        place(items, workspace, rng, margin=MARGIN)
        said = " and ".join(f"{in_words(d, phrases)} ({d.words!r})" for d in descriptions if d.part is None)
        names = sorted({name for r in relations for name in (r.subject, r.reference)})
        raise InfeasibleScene(
            f"no placement was found in which {said}",
            hint="say it otherwise, or with fewer or smaller objects",
            details={**error.details, "objects": names},
        ) from error


def _stowed(
    objects: list[NamedObject],
    poses: Mapping[str, Pose],
    context: StageContext,
    robot: Robot,
    rng: np.random.Generator,
) -> dict[str, Pose]:
    """Poses of what starts in a moving part, by id, where these are of all else."""
    parts = dict.fromkeys((o.starts_in, o.starts_in_part) for o in objects if o.starts_in_part is not None)
    by_id, found = {o.id: o for o in objects}, dict[str, Pose]()
    for name, part in parts:
        holder = _thing(by_id[str(name)], poses[str(name)], context)
        lying = [_thing(o, holder.pose, context) for o in objects if (o.starts_in, o.starts_in_part) == (name, part)]
        found |= stow(holder, str(part), lying, robot, rng)
    return found


def _thing(o: NamedObject, pose: Pose, context: StageContext) -> SceneObject:
    return SceneObject(_record(o, pose, context, ()), _asset(o, context), pose)


def _place_items(objects: list[NamedObject], template: SceneTemplate, context: StageContext) -> list[TableItem]:
    """What the placement needs of each object; what a task carries or fills must be where an arm reaches."""
    openings = _openings(objects, context)
    return [_place_item(o, objects, openings, template, context) for o in objects]


def _openings(objects: list[NamedObject], context: StageContext) -> dict[str, Opening]:
    """The room of each object that others start in, in its own frame, by its id."""
    contents: dict[str, list[Asset]] = {}
    for o in objects:
        if o.starts_in is not None and o.starts_in_part is None:
            contents.setdefault(o.starts_in, []).append(_asset(o, context))
    holders = [o for o in objects if o.id in contents]
    return {o.id: opening for o in holders if (opening := opening_for(_asset(o, context), contents[o.id])) is not None}


def _lift(o: NamedObject, objects: list[NamedObject], openings: Mapping[str, Opening]) -> float:
    """How far above the table an object stands: the floors of all that it lies in, metres."""
    holder = next((other for other in objects if other.id == o.starts_in), None)
    return openings[holder.id].floor + _lift(holder, objects, openings) if holder else 0.0


def _place_item(
    o: NamedObject,
    objects: list[NamedObject],
    openings: Mapping[str, Opening],
    template: SceneTemplate,
    context: StageContext,
) -> TableItem:
    asset = _asset(o, context)
    bounds = np.array([template.workspace.lower, template.workspace.upper])
    support = template.table.height + _lift(o, objects, openings)
    seen = view_rectangles(template.top_camera.camera(), support, float(asset.size[2]), bounds, BORDER)
    return replace(
        table_item(o.id, asset),
        allowed=context.within_reach(asset, o.role, template),
        within=seen,
        inside=o.starts_in,
        opening=openings.get(o.id),
    )


def _asset(o: NamedObject, context: StageContext) -> Asset:
    return context.library.asset(o.asset, o.variant)


def _joints(
    objects: list[NamedObject], steps: Sequence[Collection[Goal]], context: StageContext
) -> dict[str, tuple[float, ...]]:
    """Positions of the moving parts of each object: what is to be closed is open at the start, the rest at rest."""
    open_parts = open_at_start(steps)
    found = {}
    for o in objects:
        links = _asset(o, context).model.links
        there = tuple(link.joint.far_end if (o.id, link.name) in open_parts else 0.0 for link in links)
        found[o.id] = there if any(there) else ()
    return found


def _record(o: NamedObject, pose: Pose, context: StageContext, joints: tuple[float, ...]) -> ObjectRecord:
    return ObjectRecord(
        id=o.id,
        asset=o.asset,
        variant=o.variant,
        phrase=o.phrase,
        role=o.role,
        pose=PoseRecord.of(pose),
        aabb=box_record(_asset(o, context).bounds, pose),
        joints=joints,
        container=o.starts_in,
        container_part=o.starts_in_part,
    )


def photograph(scene: Scene, context: StageContext, folder: Path) -> Scene:
    """Write the pictures of the scene into a folder, and note in the scene what the segmentation's values mean."""
    look = context.appearance(scene.table.texture)
    world = World.of_scene(scene, context.physical_models(scene), appearance=look, render=True)
    shot = observe(world, scene.top_camera)
    empty = World(scene.table, {}, appearance=look, render=True)
    write_picture(folder / "source.png", shot.picture)
    write_picture(folder / "background.png", shoot(empty, scene.top_camera))
    write_labels(folder / "segmentation.png", shot.segmentation)
    write_picture(folder / "segmentation_view.png", _colour_labels(shot.segmentation))
    return scene.model_copy(update={"segmentation_ids": world.segmentation_ids})


def _colour_labels(labels: np.ndarray) -> np.ndarray:
    """(H, W, 3) picture of a label image: one hue per object, black for none."""
    hues = (labels.astype(np.int64) * 47 % 180).astype(np.uint8)
    shown = np.where(labels > 0, 230, 0).astype(np.uint8)
    return cv2.cvtColor(np.stack([hues, np.full_like(hues, 170), shown], axis=-1), cv2.COLOR_HSV2RGB)
