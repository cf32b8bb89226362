"""Find the nearest layout without collisions, rebuild it in the simulator and let it settle.

Reads place/, inpaint/ and match/. Writes optimize/scene.json and optimize/layout.png.

examples:
  vcage optimize --run runs/stationery
  vcage optimize --run runs/stationery --margin 0.05 --force
  vcage optimize --run runs/stationery --weights displacement=5,relation=0 --force
"""

from __future__ import annotations

import logging
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from vcage.base.errors import InfeasibleScene
from vcage.base.files import RunFolder
from vcage.base.geometry import Pose, wrap_angle
from vcage.base.options import NATURAL, between, number_between, value
from vcage.base.pictures import write_picture
from vcage.base.progress import Progress, silent
from vcage.layout.cost import CostWeights
from vcage.layout.items import FRONT_YAWS, TableItem, table_item
from vcage.layout.optimize import LayoutOptions, LayoutResult, displacement_summary
from vcage.layout.picture import draw_layout
from vcage.layout.stowed import with_places, with_stowed
from vcage.plans.actions import HOLDING
from vcage.plans.kept import Kept, relations_kept_in
from vcage.runs.context import StageContext
from vcage.runs.edits import Edit, Editable
from vcage.runs.inputs import read_matches, read_plan
from vcage.runs.stage import Job, StageOptions, StageResult, stage_seed
from vcage.scenes.feasible_layout import NearestFeasible, with_poses
from vcage.scenes.layout_items import Targets
from vcage.scenes.possible import SCENE_FIELDS, accepted_scene, moved_objects, settle_checks
from vcage.schema.base import Provenance
from vcage.schema.matches import Matches
from vcage.schema.plan import TABLE
from vcage.schema.scene import ObjectRecord, Scene, Workspace
from vcage.sim.cameras import shoot
from vcage.tasks.scene_objects import SceneObject

logger = logging.getLogger(__name__)


LARGEST_WEIGHT = 1e6
"""Beyond it the optimiser's own precision would be the result."""


def layout_weights(text: str) -> CostWeights:
    """``collision=1000,relation=0`` as weights; a term that is not named keeps its default.

    Raises:
        ValueError: there is no such term, or its weight is no number from 0 to :data:`LARGEST_WEIGHT`.
    """
    known = asdict(CostWeights())
    chosen: dict[str, float] = {}
    for part in text.split(","):
        name, _, weight = part.strip().partition("=")
        if name not in known:
            raise ValueError(f"no term is called {name!r}; there are: {', '.join(known)}")
        chosen[name] = number_between(0, LARGEST_WEIGHT)(weight)
    return replace(CostWeights(), **chosen)


def spelled(weights: CostWeights) -> str:
    """Weights as :func:`layout_weights` reads them."""
    return ",".join(f"{name}={weight:g}" for name, weight in asdict(weights).items())


@dataclass(frozen=True, kw_only=True)
class Options(StageOptions):
    """Options of the optimisation."""

    margin: Annotated[float, between(0, 0.5, "δ")] = 0.045
    """gap between two objects, metres: room for an open finger between any two, and a little for what settles"""
    restarts: Annotated[int, NATURAL] = 6
    """random restarts of the optimiser"""
    weights: Annotated[CostWeights, value(layout_weights, "TERM=λ,…", show=spelled)] = field(
        default_factory=CostWeights
    )
    """weights of the cost's terms; only their ratios matter, and a term that is not named keeps its default"""


def job(run: RunFolder, options: Options, _context: StageContext) -> Job:
    """Return the work of the stage."""
    return Job(
        run=run,
        output=run.layout,
        inputs=[run.scene, run.plan, run.matches],
        seed=stage_seed(run, options.seed),
        options={"margin": options.margin, "restarts": options.restarts, "weights": asdict(options.weights)},
    )


def summary(record: Scene) -> dict[str, Any]:
    """A few facts for the user of the stage."""
    return dict(record.checks)


def execute(run: RunFolder, options: Options, context: StageContext, progress: Progress = silent) -> StageResult[Scene]:
    """Write ``optimize/``: S*, a plan drawing of before and after, and the settled scene from above.

    Paper, section III-A4.

    Raises:
        InfeasibleScene: no collision-free layout was found, or the objects do not stay put in it.
    """
    stage = job(run, options, context)

    def make(folder: Path, provenance: Provenance) -> Scene:
        scene = Scene.read(run.scene)
        plan, matches = read_plan(run, scene, context), read_matches(run, scene)
        yaws = {m.object: _heading(scene.object(m.object), m.yaw, scene.workspace, context) for m in matches.matches}
        targets = _targets(scene, matches)
        own = with_places(scene)
        inside = {r.subject: r.reference for r in plan.relations if r.relation in HOLDING and r.reference != TABLE}
        turned = {key: Pose.from_yaw(target.p, yaws[key]) for key, target in targets.items() if key in own}
        how = LayoutOptions(options.weights, options.margin, options.restarts)
        wanted = Targets(turned, inside, plan.relations)
        found = NearestFeasible(scene, wanted, stage.rng, how, context).layout()
        laid_out, result = found.scene, found.result
        poses = {o.id: o.pose.pose() for o in laid_out.objects}
        write_picture(folder / "layout.png", _drawing(scene, context, with_stowed(scene, targets), poses))
        settled, picture = _rebuild(laid_out, context)
        write_picture(folder / "top.png", picture)
        kept = relations_kept_in(settled, plan.relations)
        if kept.broken:
            logger.warning("the layout keeps %.0f %% of the plan: not %s", 100 * kept.share, ", ".join(kept.sentences))
        checks = {**settled.checks, **_checks(kept, result), "targets_shifted_m": found.shift_m}
        return settled.model_copy(
            update={"provenance": provenance, "edited": [], "checks": checks}
            | {"pictures": {"top": stage.inside("top.png")}}
        )

    return stage.do(Scene, make, force=options.force)


def _accept(edit: Edit[Scene]) -> Scene:
    """Check an edited S*, and draw and measure it as it settles, without the figures of the optimisation."""
    if not edit.changes(*SCENE_FIELDS):
        return edit.record
    settled, run, context = accepted_scene(edit), edit.run, edit.context
    write_picture(edit.folder / "top.png", shoot(context.drawn_world(settled), settled.top_camera))
    if not run.matches.exists():  # a sub-task that runs alone has no plan
        return settled
    targets = with_stowed(settled, _targets(settled, read_matches(run, settled)))
    poses = {o.id: o.pose.pose() for o in settled.objects}
    write_picture(edit.folder / "layout.png", _drawing(settled, context, targets, poses))
    kept = relations_kept_in(settled, read_plan(run, settled, context).relations)
    return settled.model_copy(update={"checks": {**settled.checks, **_plan_figures(kept)}})


EDITABLE = Editable(Scene, fields=SCENE_FIELDS, pictures=True, accept=_accept)


def _targets(scene: Scene, matches: Matches) -> dict[str, Pose]:
    """Poses at which the objects were matched, by id."""
    return {m.object: Pose.from_yaw([*m.position, scene.table.height], m.yaw) for m in matches.matches}


def _plan_figures(kept: Kept) -> dict[str, Any]:
    return {"relations_kept": round(kept.share, 4), "relations_broken": kept.sentences}


def _checks(kept: Kept, result: LayoutResult) -> dict[str, Any]:
    """Figures of the optimisation for the scene's record."""
    return {
        **_plan_figures(kept),
        "displacement": displacement_summary(result.displaced),
        "cost_before": result.cost_before.total,
        "cost_after": result.cost_after.total,
        "starts": result.starts,
        "repaired": result.repaired,
        "released": result.released,
        "out_of_reach": result.out_of_reach,
        "hand_room": round(result.hand_room, 4),
    }


def _heading(record: ObjectRecord, yaw: float, workspace: Workspace, context: StageContext) -> float:
    """The matched heading; an object with a front is turned back until that faces the robot, and straight where the
    workspace has no room for it and its open parts otherwise. A round object has no heading, and takes one at which its
    box needs the least room."""
    asset = context.asset(record)
    if not asset.articulated:
        return float(np.round(yaw / (np.pi / 2)) * np.pi / 2) if asset.round else yaw
    turned = float(np.clip(wrap_angle(yaw), min(FRONT_YAWS), max(FRONT_YAWS)))
    c, s = abs(np.cos(turned)), abs(np.sin(turned))
    needs = np.array([[c, s], [s, c]]) @ table_item(record.id, asset).size[:2]
    if np.any(needs > np.subtract(workspace.upper, workspace.lower)):
        turned = 0.0
    if abs(wrap_angle(turned - yaw)) > 1e-6:
        logger.warning("%s is turned by %.0f°, so its front faces the robot", record.id, np.degrees(turned - yaw))
    return turned


def _rebuild(scene: Scene, context: StageContext) -> tuple[Scene, np.ndarray]:
    """The layout as it settles in the simulator, where it must stay put, and its (H, W, 3) picture from above."""
    world = context.drawn_world(scene)
    report = world.settle()
    moved = moved_objects(report, scene.objects)
    if moved or not report.settled:
        raise InfeasibleScene(
            f"the optimised layout does not hold: {', '.join(moved or report.fallen) or 'something'} moves",
            hint="try another --seed, or a larger --margin",
            details={"objects": moved, "drift_mm": {k: round(1000 * v, 2) for k, v in report.drift_m.items()}},
        )
    settled = with_poses(scene, context, world.object_poses()).model_copy(update={"checks": settle_checks(report)})
    return settled, shoot(world, scene.top_camera)


def _drawing(scene: Scene, context: StageContext, before: dict[str, Pose], after: dict[str, Pose]) -> np.ndarray:
    was, becomes = ([_table_item(o) for o in context.objects(scene, poses)] for poses in (before, after))
    return draw_layout(was, becomes, {o.id: o.phrase for o in scene.objects}, scene.workspace, scene.table)


def _table_item(o: SceneObject) -> TableItem:
    (x, y), (width, depth, height) = o.pose.p[:2].tolist(), o.asset.size.tolist()
    return TableItem(o.id, (width, depth, height), (o.pose.yaw,), (x, y), inside=o.record.container)
