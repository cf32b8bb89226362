"""Stage 3: find each object again in the target picture, and where that is in the world (paper, section III-A3)."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

from vcage.base.files import RunFolder
from vcage.base.geometry import Pose
from vcage.base.pictures import read_picture, write_picture
from vcage.base.progress import Progress, silent
from vcage.matching.match import Looks, Recogniser, match_picture
from vcage.matching.overlay import draw_overlay
from vcage.plans.kept import Kept, relations_kept
from vcage.schema.base import Box, Provenance, box_record
from vcage.schema.matches import Match, Matches
from vcage.schema.scene import Scene
from vcage.sim.drawer import ModelDrawer
from vcage.stages.context import Workbench
from vcage.stages.inputs import read_pictures, read_plan
from vcage.stages.settings import Settings
from vcage.stages.stage import Job, StageResult, stage_seed

logger = logging.getLogger(__name__)

PLAN_SHOWN = 0.7
"""A picture that shows less of the plan than this share does not look like a drawing of it."""


def job(run: RunFolder, settings: Settings, bench: Workbench) -> Job:
    """What the stage has to do."""
    return Job(
        run=run,
        output=run.matches,
        inputs=[
            run.scene,
            *(run.scene.parent / f"{name}.png" for name in ("source", "background", "segmentation")),
            run.plan,
            run.plan.parent / "target.png",
        ],
        seed=stage_seed(run, settings.seed),
        options={"threshold": settings.threshold},
        providers=bench.models.providers("detector", "embedder"),
    )


def summary(record: Matches) -> dict[str, Any]:
    """A few facts for whoever ran the stage."""
    kept = {m.object: m.note for m in record.matches if m.method == "kept"}
    return {
        "matched": len(record.matches) - len(kept),
        "of": len(record.matches),
        "kept": kept,
        "notes": record.notes,
        **record.checks,
    }


def execute(run: RunFolder, settings: Settings, bench: Workbench, progress: Progress = silent) -> StageResult[Matches]:
    """Write ``match/``: the matches and an overlay picture."""
    stage = job(run, settings, bench)

    def make(folder: Path, provenance: Provenance) -> Matches:
        scene = Scene.read(run.scene)
        plan = read_plan(run, scene, bench)
        found = match_picture(
            scene,
            plan,
            read_pictures(run, scene),
            read_picture(run.root / plan.target),
            Recogniser(bench.models.detector, bench.models.embedder, settings.threshold),
            Looks({o.id: bench.symmetry(o) for o in scene.objects}, ModelDrawer(bench.physical_models(scene))),
        )
        shown = relations_kept(plan.relations, _boxes(scene, found.matches, bench), scene.table)
        notes = found.notes + _doubts(found.matches, shown)
        for note in notes:
            logger.warning("%s", note)
        write_picture(folder / "overlay.png", draw_overlay(found.picture, scene, found.matches, found.unclaimed))
        return Matches(
            provenance=provenance,
            threshold=settings.threshold,
            matches=found.matches,
            unclaimed=found.unclaimed,
            overlay=stage.inside("overlay.png"),
            notes=notes,
            checks={"relations_shown": round(shown.share, 4), "relations_not_shown": shown.sentences},
        )

    return stage.do(Matches, make, force=settings.force)


def _boxes(scene: Scene, matches: list[Match], bench: Workbench) -> dict[str, Box]:
    """World boxes of the objects where they were matched, by id."""
    boxes = {}
    for m in matches:
        record = scene.object(m.object)
        pose = Pose.from_yaw([*m.position, record.pose.position[2]], m.yaw)
        boxes[m.object] = box_record(bench.asset(record).bounds, pose)
    return boxes


def _doubts(matches: list[Match], shown: Kept) -> list[str]:
    """What makes the picture as a whole doubtful."""
    if all(m.method == "kept" for m in matches):
        return ["the target picture shows none of the scene's objects; all keep their place from the plan"]
    if shown.share < PLAN_SHOWN:
        return [f"the target picture shows only {shown.share:.0%} of the plan: {', '.join(shown.sentences)}"]
    return []
