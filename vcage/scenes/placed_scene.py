"""Placement of chosen objects on the table: draw until one stays put, and take its pictures."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from vcage.base.attempts import LIMITS, GaveUp, first_accepted
from vcage.base.errors import InfeasibleScene
from vcage.base.pictures import write_labels, write_picture
from vcage.models.selection_check import NamedObject
from vcage.runs.context import StageContext
from vcage.scenes.possible import moved_objects, settle_checks
from vcage.scenes.starting_poses import StartingPoses
from vcage.schema.scene import Scene, SceneTemplate
from vcage.sim.cameras import observe, shoot
from vcage.sim.world import World
from vcage.tasks.described import complaints


def place_until_stable(
    fields: dict[str, Any],
    objects: list[NamedObject],
    template: SceneTemplate,
    context: StageContext,
    rng: np.random.Generator,
) -> Scene:
    """Draw placements until one stays put in the simulator; M records its settled poses.

    Args:
        fields: of the scene, but for objects and checks.
        objects: that are placed.
        template: of the scene.
        context: the library.
        rng: of the placements.

    Raises:
        InfeasibleScene: the objects have no place, do not stay where they are put, or a description is not true.
    """
    starting = StartingPoses(objects, template, fields.get("descriptions", ()), fields.get("goals", ()), context)

    def place(number: int) -> Scene:
        scene = Scene(**fields, objects=starting.records(starting.draw(rng)))
        world = World.of_scene(scene, context.physical_models(scene))
        report = world.settle()
        moved = moved_objects(report, scene.objects)
        if moved or not report.settled:
            raise _Unstable(moved)
        checks = {**settle_checks(report), "placements": number}
        scene = Scene(**fields, objects=starting.records(world.object_poses()), checks=checks)
        if false := complaints(scene, context.objects(scene)):
            raise _NotAsDescribed(false)
        return scene

    numbers = range(1, LIMITS.placements + 1)
    try:
        return first_accepted((partial(place, number) for number in numbers), (_Unstable, _NotAsDescribed)).value
    except GaveUp as error:
        raise _given_up(error.refusals) from None


class _Unstable(Exception):
    """Objects that do not stay where they are put."""


class _NotAsDescribed(Exception):
    """Descriptions that are not true of a placement."""


def _given_up(refusals: Sequence[Exception]) -> InfeasibleScene:
    """The error for a scene without an accepted placement."""
    false = [refusal.args[0] for refusal in refusals if isinstance(refusal, _NotAsDescribed)]
    unstable = refusals[-1]
    if isinstance(unstable, _Unstable) and (unstable.args[0] or not false):
        moved = unstable.args[0]
        return InfeasibleScene(
            f"{', '.join(moved) or 'the objects'} did not stay where they were put in {len(refusals)} placements",
            hint="check their collision hulls, or leave them out",
            details={"objects": moved},
        )
    return InfeasibleScene(
        f"in none of {len(refusals)} placements all of the instruction was true of the start: {'; '.join(false[-1])}",
        hint="say it otherwise, or with fewer objects",
        details={"descriptions": false[-1]},
    )


def photograph(scene: Scene, context: StageContext, folder: Path) -> Scene:
    """Write the pictures of the scene into a folder, and note the meaning of the segmentation's values in the scene."""
    world, empty = context.drawn_world(scene), context.drawn_world(scene.model_copy(update={"objects": []}))
    shot = observe(world, scene.top_camera)
    write_picture(folder / "source.png", shot.picture)
    write_picture(folder / "background.png", shoot(empty, scene.top_camera))
    labels, ids = shot.segmentation.copy(), dict(world.segmentation_ids)
    for heaped in (o for o in scene.objects if o.heaped):  # goes along with its container, and is cut out with it
        labels[shot.segmentation == ids.pop(heaped.id)] = ids[str(heaped.container)]
    write_labels(folder / "segmentation.png", labels)
    write_picture(folder / "segmentation_view.png", _colour_labels(labels))
    return scene.model_copy(update={"segmentation_ids": ids})


def _colour_labels(labels: np.ndarray) -> np.ndarray:
    """(H, W, 3) picture of a label image: one hue per object, black for none."""
    hues = (labels.astype(np.int64) * 47 % 180).astype(np.uint8)
    shown = np.where(labels > 0, 230, 0).astype(np.uint8)
    return cv2.cvtColor(np.stack([hues, np.full_like(hues, 170), shown], axis=-1), cv2.COLOR_HSV2RGB)
