"""Stage 4: the nearest collision-free layout, rebuilt in the simulator (paper, section III-A4)."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from vcage.base.errors import InfeasibleScene
from vcage.base.files import RunFolder
from vcage.base.geometry import Pose, wrap_angle
from vcage.base.pictures import write_picture
from vcage.base.progress import Progress, silent
from vcage.layout.capacities import opening_for
from vcage.layout.items import FRONT_YAWS, TableItem, table_item
from vcage.layout.optimize import LayoutResult, displacement_summary, optimize_layout
from vcage.layout.picture import Footprint, draw_layout
from vcage.layout.placement.reach import reach_for
from vcage.plans.kept import relations_kept_in
from vcage.schema.base import PoseRecord, Provenance, box_record
from vcage.schema.matches import Matches
from vcage.schema.plan import TABLE, Plan
from vcage.schema.scene import ObjectRecord, Scene
from vcage.sim.cameras import shoot
from vcage.sim.world import World
from vcage.stages.context import Workbench
from vcage.stages.inputs import read_matches, read_plan
from vcage.stages.settings import Settings
from vcage.stages.stability import moved_objects, settle_checks
from vcage.stages.stage import Job, StageResult, stage_seed
from vcage.tasks.scene_objects import SceneObject

logger = logging.getLogger(__name__)


def job(run: RunFolder, settings: Settings, _bench: Workbench) -> Job:
    """What the stage has to do."""
    return Job(
        run=run,
        output=run.layout,
        inputs=[run.scene, run.plan, run.matches],
        seed=stage_seed(run, settings.seed),
        options={"margin": settings.margin, "restarts": settings.restarts, "weights": asdict(settings.weights)},
    )


def summary(record: Scene) -> dict[str, Any]:
    """A few facts for whoever ran the stage."""
    return dict(record.checks)


def execute(run: RunFolder, settings: Settings, bench: Workbench, progress: Progress = silent) -> StageResult[Scene]:
    """Write ``optimize/``: S*, a plan drawing of before and after, and the settled scene from above.

    Raises:
        InfeasibleScene: no collision-free layout was found, or the objects do not stay put in it.
    """
    stage = job(run, settings, bench)

    def make(folder: Path, provenance: Provenance) -> Scene:
        scene = Scene.read(run.scene)
        plan, matches = read_plan(run, scene, bench), read_matches(run, scene)
        objects = bench.objects(scene)
        yaws = {m.object: _heading(scene.object(m.object), m.yaw, bench) for m in matches.matches}
        result = optimize_layout(
            _items(objects, matches, yaws, plan, bench.reach(scene.robot, scene.workspace, scene.table)),
            np.array([scene.workspace.lower, scene.workspace.upper]),
            stage.rng(),
            table_height=scene.table.height,
            weights=settings.weights,
            margin=settings.margin,
            restarts=settings.restarts,
            relations=plan.relations,
            table=scene.table,
        )
        poses = {key: Pose.from_yaw(position, yaws[key]) for key, position in result.positions.items()}
        targets = {m.object: Pose.from_yaw([*m.position, scene.table.height], m.yaw) for m in matches.matches}
        write_picture(folder / "layout.png", _drawing(scene, bench, targets, poses))
        settled = _rebuild(_with_poses(scene, bench, poses, result), bench, folder)
        kept = relations_kept_in(settled, plan.relations)
        if kept.broken:
            logger.warning("the layout keeps %.0f %% of the plan: not %s", 100 * kept.share, ", ".join(kept.sentences))
        checks = {
            **settled.checks,
            "relations_kept": round(kept.share, 4),
            "relations_broken": kept.sentences,
            "displacement": displacement_summary(result.displaced),
            "cost_before": result.cost_before.total,
            "cost_after": result.cost_after.total,
            "starts": result.starts,
            "repaired": result.repaired,
            "released": result.released,
            "out_of_reach": result.out_of_reach,
            "hand_room": round(result.hand_room, 4),
        }
        return settled.model_copy(
            update={"provenance": provenance, "checks": checks, "pictures": {"top": stage.inside("top.png")}}
        )

    return stage.do(Scene, make, force=settings.force)


def _heading(record: ObjectRecord, yaw: float, bench: Workbench) -> float:
    """The heading that was matched; what opens at its front is turned back until that faces the robot."""
    asset = bench.asset(record)
    if not asset.articulated:
        return yaw
    turned = float(np.clip(wrap_angle(yaw), min(FRONT_YAWS), max(FRONT_YAWS)))
    if abs(wrap_angle(turned - yaw)) > 1e-6:
        logger.warning("%s is turned by %.0f°, so that its front faces the robot", record.id, np.degrees(turned - yaw))
    return turned


def _items(
    objects: list[SceneObject], matches: Matches, yaws: Mapping[str, float], plan: Plan, reach: np.ndarray
) -> list[TableItem]:
    """What the optimisation needs of each object."""
    places = {m.object: m.position for m in matches.matches}
    inside = {r.subject: r.reference for r in plan.relations if r.relation in ("inside", "on") and r.reference != TABLE}
    items = []
    for o in objects:
        contents = [other.asset for other in objects if inside.get(other.id) == o.id]
        items.append(
            table_item(
                o.id,
                o.asset,
                yaws=(yaws[o.id],),
                target=places[o.id],
                opening=opening_for(o.asset, contents),
                inside=inside.get(o.id),
                allowed=reach_for(o.asset, o.record.role, reach),
                grasped=o.record.role == "content",
            )
        )
    return items


def _with_poses(scene: Scene, bench: Workbench, poses: dict[str, Pose], result: LayoutResult | None = None) -> Scene:
    """The scene with its objects at other poses, and in the containers that the optimisation found."""
    records = [_moved(o, bench, poses[o.id]) for o in scene.objects]
    if result is not None:
        records = [o.model_copy(update={"container": result.containers[o.id]}) for o in records]
    return scene.model_copy(update={"objects": records, "segmentation_ids": {}, "checks": {}})


def _moved(o: ObjectRecord, bench: Workbench, pose: Pose) -> ObjectRecord:
    return o.model_copy(update={"pose": PoseRecord.of(pose), "aabb": box_record(bench.asset(o).bounds, pose)})


def _rebuild(scene: Scene, bench: Workbench, folder: Path) -> Scene:
    """Build the layout in the simulator, prove that it stays put, and photograph it."""
    look = bench.appearance(scene.table.texture)
    world = World.of_scene(scene, bench.physical_models(scene), appearance=look, render=True)
    report = world.settle()
    moved = moved_objects(report)
    if moved or not report.settled:
        raise InfeasibleScene(
            f"the optimised layout does not hold: {', '.join(moved or report.fallen) or 'something'} moves",
            hint="try another --seed, or a larger --margin",
            details={"objects": moved, "drift_mm": {k: round(1000 * v, 2) for k, v in report.drift_m.items()}},
        )
    write_picture(folder / "top.png", shoot(world, scene.top_camera))
    return _with_poses(scene, bench, world.object_poses()).model_copy(update={"checks": settle_checks(report)})


def _drawing(scene: Scene, bench: Workbench, before: dict[str, Pose], after: dict[str, Pose]) -> np.ndarray:
    plans = ([_footprint(o) for o in bench.objects(scene, poses)] for poses in (before, after))
    return draw_layout(*plans, scene.workspace, scene.table)


def _footprint(o: SceneObject) -> Footprint:
    x, y = (float(v) for v in o.pose.p[:2])
    width, depth = (float(v) for v in o.asset.footprint)
    return Footprint(o.id, o.record.phrase, (x, y), (width, depth), o.pose.yaw, o.record.container)
