"""Stage 3: find each object again in the target picture, and where that is in the world (paper, section III-A3)."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

from vcage.files import RunFolder
from vcage.igsc.match import ScenePictures, match_picture
from vcage.igsc.overlay import draw_overlay
from vcage.pictures import read_labels, read_picture, write_picture
from vcage.pipeline.settings import Settings
from vcage.pipeline.stage import Job, StageResult, stage_seed
from vcage.pipeline.workbench import Workbench
from vcage.progress import Progress, silent
from vcage.schema.base import Provenance
from vcage.schema.matches import Matches
from vcage.schema.plan import Plan
from vcage.schema.scene import Scene

logger = logging.getLogger(__name__)


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
    }


def execute(run: RunFolder, settings: Settings, bench: Workbench, progress: Progress = silent) -> StageResult[Matches]:
    """Write ``match/``: the matches and an overlay picture."""
    stage = job(run, settings, bench)

    def make(folder: Path, provenance: Provenance) -> Matches:
        scene, plan = Scene.read(run.scene), Plan.read(run.plan)
        pictures = ScenePictures(
            source=read_picture(run.root / scene.pictures["source"]),
            segmentation=read_labels(run.root / scene.pictures["segmentation"]),
            background=read_picture(run.root / scene.pictures["background"]),
        )
        found = match_picture(
            scene,
            plan,
            pictures,
            read_picture(run.root / plan.target),
            bench.models.detector,
            bench.models.embedder,
            threshold=settings.threshold,
            symmetry={o.id: bench.symmetry(o) for o in scene.objects},
        )
        for note in found.notes:
            logger.warning("%s", note)
        write_picture(folder / "overlay.png", draw_overlay(found.picture, scene, found.matches, found.unclaimed))
        return Matches(
            provenance=provenance,
            threshold=settings.threshold,
            matches=found.matches,
            unclaimed=found.unclaimed,
            overlay=stage.inside("overlay.png"),
            notes=found.notes,
        )

    return stage.do(Matches, make, force=settings.force)
