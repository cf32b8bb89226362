"""The layouts that are compared: naive, unplanned, and through the IGSC stages."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from vcage.base.files import RunFolder
from vcage.layout.items import ANY_YAW, TableItem
from vcage.layout.placement.place import place
from vcage.models.selection_check import NamedObject
from vcage.objects.asset import Asset
from vcage.runs.context import StageContext
from vcage.scenes import placed_scene
from vcage.scenes.feasible_layout import with_poses
from vcage.schema.scene import Scene
from vcage.sim.robots import load_template
from vcage.sim.world import World
from vcage.stages import inpaint_plan, match, optimize

LAYOUTS = ("naive", "unplanned", "igsc")


def laid_out(layout: str, drawn: Scene, seed: int, context: StageContext) -> Scene:
    """The objects of a scene in a layout of one kind.

    Args:
        layout: one of :data:`LAYOUTS`.
        drawn: the objects, and the task.
        seed: of the layout.
        context: the library and the offline models.

    Raises:
        VcageError: a stage refuses, or the objects have no room.
    """
    if layout == "naive":
        return naive(drawn, np.random.default_rng([seed, 2]), context)
    placed = _placed(drawn, np.random.default_rng([seed, 1]), context)
    return placed if layout == "unplanned" else _planned(placed, seed, context)


def naive(drawn: Scene, rng: np.random.Generator, context: StageContext) -> Scene:
    """Boxes that do not meet anywhere in the workspace, at any heading, and the objects as they come to rest.

    Raises:
        InfeasibleScene: there is no room for all.
    """
    items = [_box(o.id, context.asset(o)) for o in drawn.objects]
    workspace = np.array([drawn.workspace.lower, drawn.workspace.upper])
    spots = place(items, workspace, rng, margin=0.0)
    put = with_poses(drawn, context, {item.id: item.pose(spots[item.id], drawn.table.height) for item in items})
    world = World.of_scene(put, context.physical_models(put))
    world.settle()
    return with_poses(put, context, world.object_poses())


def _box(name: str, asset: Asset) -> TableItem:
    """The box of an object at rest as an item of the placement; nothing else is known of it."""
    body, size = asset.bounds[:, :2], asset.size.tolist()
    return TableItem(name, (size[0], size[1], size[2]), ANY_YAW, centre=tuple(body.mean(axis=0).tolist()), body=body)


def _placed(drawn: Scene, rng: np.random.Generator, context: StageContext) -> Scene:
    """This project's placement, which knows the arms' reach, the camera's view and fronts."""
    return placed_scene.place_until_stable(
        _kept(drawn), _named(drawn), load_template(drawn.template, drawn.robot), context, rng
    )


def _kept(drawn: Scene) -> dict[str, Any]:
    """The fields of a scene that do not follow from where its objects are."""
    return {name: getattr(drawn, name) for name in Scene.model_fields if name not in ("objects", "checks", "schema_id")}


def _named(drawn: Scene) -> list[NamedObject]:
    return [NamedObject(o.id, o.asset, o.variant, o.phrase, o.role, o.container) for o in drawn.objects]


def _planned(placed: Scene, seed: int, context: StageContext) -> Scene:
    """The layout that the IGSC stages make of a placement."""
    with tempfile.TemporaryDirectory() as folder:
        run = RunFolder(Path(folder) / "run")
        run.scene.parent.mkdir(parents=True)
        placed_scene.photograph(placed, context, run.scene.parent).write(run.scene)
        inpaint_plan.execute(run, inpaint_plan.Options(models="offline", seed=seed), context)
        match.execute(run, match.Options(models="offline", seed=seed), context)
        optimize.execute(run, optimize.Options(seed=seed), context)
        return Scene.read(run.layout)
