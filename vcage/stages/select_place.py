"""Choose the objects for an instruction, or those of a scene template, and place them on the table without collision.

Writes place/scene.json (objects, poses, camera), source.png, background.png and segmentation.png.

examples:
  vcage select-place "Pack the marker pens and the eraser into the box" --out runs/stationery
  vcage select-place "Put the blocks on the plate" --out runs/blocks --seed 7 --force
  vcage select-place --scene office_desk --out runs/office
  vcage select-place "Put the apple into the bowl" --robot dual_panda --out runs/apple
"""

from __future__ import annotations

import logging
import unicodedata
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import cv2
import numpy as np
from tyro.conf import Positional, arg

from vcage.base.errors import InfeasibleScene, UsageError
from vcage.base.files import RunFolder
from vcage.base.geometry import Pose
from vcage.base.options import UNSAID
from vcage.base.pictures import write_labels, write_picture
from vcage.base.progress import Progress, silent
from vcage.layout.capacities import capacity_of, opening_for
from vcage.layout.items import TableItem, table_item
from vcage.layout.placement.place import place
from vcage.layout.placement.view import view_rectangles
from vcage.models.scene_contents import draw_contents
from vcage.models.selection_check import NamedObject, name_objects, validate_selection, with_room
from vcage.objects.asset import Asset
from vcage.objects.openings import Opening
from vcage.plans.actions import open_at_start
from vcage.schema.asset import CatalogueEntry
from vcage.schema.base import PoseRecord, Provenance, box_record
from vcage.schema.goals import Goal, in_steps
from vcage.schema.plan import Selection
from vcage.schema.scene import ObjectRecord, Scene, SceneTemplate
from vcage.sim.cameras import observe, shoot
from vcage.sim.robots import available, load_template
from vcage.sim.world import World
from vcage.stages.context import StageContext
from vcage.stages.edits import written_record
from vcage.stages.possible import edited_scene
from vcage.stages.stability import moved_objects, settle_checks
from vcage.stages.stage import Job, ModelOptions, StageResult
from vcage.tasks.search import require_way

logger = logging.getLogger(__name__)

LONGEST_INSTRUCTION = 1000
"""Characters."""

MARGIN = 0.015
"""Smallest gap between two objects, metres: wide enough for the picture to show the table between them."""

BORDER = 2.0
"""Pixels that stay free between an object and the edge of the top view."""

TRIES = 5
"""Placements that are drawn before a scene whose objects do not stay put is given up."""


@dataclass(frozen=True, kw_only=True)
class Options(ModelOptions):
    """What begins a run."""

    instruction: Annotated[str | None, Positional, arg(metavar="[instruction]"), UNSAID] = None
    """the task in plain language, in quotes; without one, the objects are those that belong to the scene template"""
    template: Annotated[str, arg(name="scene", metavar="TEMPLATE")] = "table"
    """the scene template"""
    robot: Annotated[str | None, arg(metavar="ROBOT"), UNSAID] = None
    """the robot (default: that of the scene template); ``vcage robots list`` says which"""


def job(run: RunFolder, options: Options, context: StageContext) -> Job:
    """What the stage has to do.

    Raises:
        UsageError: the instruction is empty, too long or no text; or there is none, and nothing belongs to the scene.
    """
    asked: dict[str, Any] = {"instruction": None, "template": options.template}
    asked["robot"] = load_template(options.template, options.robot).robot
    if options.instruction is not None:
        asked["instruction"] = _read(options.instruction)
    else:
        asked["contents"] = [one.model_dump(mode="json") for one in _with_contents(options.template).contents]
    return Job(
        run=run,
        output=run.scene,
        seed=options.seed or 0,
        options=asked,
        providers=context.models.providers("reasoner") if asked["instruction"] else {},
    )


def _with_contents(name: str) -> SceneTemplate:
    """The scene template, which says what belongs there."""
    template = load_template(name)
    if not template.contents:
        others = [other for other in available("scenes") if load_template(other).contents]
        raise UsageError(
            f"the scene {name} says nothing of what belongs there, and there is no instruction",
            hint=f'give one in quotes: "Put the blocks on the plate", or --scene with one of: {", ".join(others)}',
        )
    return template


def _read(instruction: str) -> str:
    """The instruction in one line."""
    instruction = " ".join(instruction.split())
    if not instruction:
        raise UsageError("the instruction is empty", hint='give it in quotes: "Put the blocks on the plate"')
    if len(instruction) > LONGEST_INSTRUCTION:
        raise UsageError(
            f"the instruction has {len(instruction)} characters, at most {LONGEST_INSTRUCTION} are read",
            hint="make a run of each part",
        )
    if any(unicodedata.category(c) in ("Cc", "Cs") for c in instruction):
        raise UsageError(
            f"the instruction {instruction!r} holds what is no text",
            hint="write it in UTF-8, without control characters",
        )
    return instruction


def summary(record: Scene) -> dict[str, Any]:
    """A few facts for whoever ran the stage."""
    goals = [str(asked.goal) for asked in record.goals]
    return {"objects": [o.id for o in record.objects], "goals": goals, **record.checks}


def execute(run: RunFolder, options: Options, context: StageContext, progress: Progress = silent) -> StageResult[Scene]:
    """Write ``place/``: M, the top view, the empty table, the segmentation.

    Raises:
        NoAssetFits: the catalogue has nothing that the instruction names, or too little of what belongs to the scene.
        UnknownName: it has nothing with a tag or name of what belongs to the scene.
        UnreadInstruction: words of the instruction answer to no goal.
        NoFeasibleTask: the sizes of the objects rule out a goal, wherever they stand.
        ModelRefused: the reasoner was told what is wrong with its selection and found no better one in its rounds.
        InfeasibleScene: the objects have no place, or do not stay where they are put.
    """
    stage = job(run, options, context)

    def make(folder: Path, provenance: Provenance) -> Scene:
        rng = stage.rng()
        template = load_template(options.template, options.robot)
        instruction = stage.options["instruction"]
        selection = _selection(instruction, template, context, rng)
        objects = name_objects(selection, context.catalogue)
        objects, crowded = with_room(objects, {o.id: capacity_of(o.id, _asset(o, context)) for o in objects})
        notes = [*selection.notes, *crowded]
        for note in notes:
            logger.warning("%s", note)
        scene = _empty_scene(template, instruction, provenance, stage)
        if instruction is not None:
            lying = {o.id: o.starts_in for o in objects if o.starts_in is not None}
            reading = context.models.reasoner.read_goals(instruction, _kinds(objects, context), lying)
            scene |= {"goals": reading.goals, "untouched": reading.untouched}
        placed = place_until_stable(scene, objects, template, context, rng)
        require_way(placed, context.objects(placed))
        noted = placed.model_copy(update={"checks": {**placed.checks, "notes": notes}})
        return photograph(noted, context, folder)

    return stage.do(Scene, make, force=options.force)


def take_over(run: RunFolder, folder: Path, edited: Collection[str], context: StageContext) -> Scene:
    """M as it was edited by hand: as it settles, with pictures of that.

    Raises:
        InputFileError: it is not possible.
    """
    if run.scene.name not in edited:
        return Scene.read(run.scene)
    settled = edited_scene(run.scene, context)
    notes = written_record(run.scene, Scene).checks.get("notes", [])
    return photograph(settled.model_copy(update={"checks": {**settled.checks, "notes": notes}}), context, folder)


def _selection(
    instruction: str | None, template: SceneTemplate, context: StageContext, rng: np.random.Generator
) -> Selection:
    """What the reasoner chooses for an instruction; without one, a draw of what belongs to the scene."""
    if instruction is None:
        return draw_contents(template, context.catalogue, rng)
    check = partial(validate_selection, entries=context.catalogue)
    return context.models.reasoner.select_assets(instruction, context.catalogue, rng, check)


def _kinds(objects: Sequence[NamedObject], context: StageContext) -> dict[str, CatalogueEntry]:
    """The catalogue's entry of each object, with no other look than its own, by its id."""
    entries = {entry.name: entry for entry in context.catalogue}
    return {
        o.id: entries[o.asset].model_copy(
            update={"variants": [v for v in entries[o.asset].variants if v.id == o.variant]}
        )
        for o in objects
    }


def _empty_scene(template: SceneTemplate, instruction: str | None, provenance: Provenance, stage: Job) -> dict:
    """The fields of the scene that do not depend on the objects."""
    return {
        "provenance": provenance,
        "instruction": instruction,
        "template": template.name,
        "robot": template.robot,
        "table": template.table,
        "workspace": template.workspace,
        "top_camera": template.top_camera,
        "pictures": {name: stage.inside(f"{name}.png") for name in ("source", "background", "segmentation")},
    }


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
    workspace = np.array([template.workspace.lower, template.workspace.upper])
    items = _place_items(objects, template, context)
    height = template.table.height
    joints = _joints(objects, in_steps(fields.get("goals", ())), context)
    worst: list[str] = []
    for attempt in range(1, TRIES + 1):
        spots = place(items, workspace, rng, margin=MARGIN)
        poses = {item.id: item.pose(spots[item.id], height + spots[item.id].z) for item in items}
        scene = Scene(**fields, objects=[_record(o, poses[o.id], context, joints[o.id]) for o in objects])
        world = World.of_scene(scene, context.physical_models(scene))
        report = world.settle()
        worst = moved_objects(report)
        if report.settled and not worst:
            poses = world.object_poses()
            checks = {**settle_checks(report), "placements": attempt}
            return Scene(
                **fields, objects=[_record(o, poses[o.id], context, joints[o.id]) for o in objects], checks=checks
            )
    raise InfeasibleScene(
        f"{', '.join(worst) or 'the objects'} did not stay where they were put in {TRIES} placements",
        hint="check their collision hulls, or leave them out",
        details={"objects": worst},
    )


def _place_items(objects: list[NamedObject], template: SceneTemplate, context: StageContext) -> list[TableItem]:
    """What the placement needs of each object; what a task carries or fills must be where an arm reaches."""
    openings = _openings(objects, context)
    return [_place_item(o, objects, openings, template, context) for o in objects]


def _openings(objects: list[NamedObject], context: StageContext) -> dict[str, Opening]:
    """The room of each object that others start in, in its own frame, by its id."""
    contents: dict[str, list[Asset]] = {}
    for o in objects:
        if o.starts_in is not None:
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
