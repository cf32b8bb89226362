"""Placing chosen objects on the table: placements are drawn until one stays put, and its pictures are taken."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np

from vcage.base.errors import InfeasibleScene
from vcage.base.pictures import write_labels, write_picture
from vcage.models.selection_check import NamedObject
from vcage.runs.context import StageContext
from vcage.scenes.stability import moved_objects, settle_checks
from vcage.scenes.starting_poses import StartingPoses
from vcage.schema.scene import Scene, SceneTemplate
from vcage.sim.cameras import observe, shoot
from vcage.sim.world import World
from vcage.tasks.described import complaints

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
        InfeasibleScene: the objects have no place, do not stay where they are put, or what is described is not true.
    """
    starting = StartingPoses(objects, template, fields.get("descriptions", ()), fields.get("goals", ()), context)
    worst: list[str] = []
    false: list[str] = []
    for attempt in range(1, TRIES + 1):
        poses = starting.draw(rng)
        scene = Scene(**fields, objects=starting.records(poses))
        world = World.of_scene(scene, context.physical_models(scene))
        report = world.settle()
        worst = moved_objects(report)
        if report.settled and not worst:
            poses = world.object_poses()
            checks = {**settle_checks(report), "placements": attempt}
            scene = Scene(**fields, objects=starting.records(poses), checks=checks)
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
