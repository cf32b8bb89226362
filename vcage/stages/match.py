"""Find each object again in the target picture: position and rotation in the world.

Reads place/ and inpaint/. Writes match/matches.json and match/overlay.png.

examples:
  vcage match --run runs/stationery
  vcage match --run runs/stationery --threshold 0.7 --force
  vcage match --run runs/stationery --detector grounding-dino --embedder dinov2:~/models/dinov2-small --force
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from tyro.conf import arg

from vcage.base.files import RunFolder
from vcage.base.geometry import Pose
from vcage.base.options import between, value
from vcage.base.pictures import read_picture, write_picture
from vcage.base.progress import Progress, silent
from vcage.models.registry import DETECTORS, EMBEDDERS, split_weights
from vcage.plans.kept import Kept, relations_kept
from vcage.plans.relations import ground_box
from vcage.runs.context import StageContext
from vcage.runs.edits import Edit, Editable
from vcage.runs.inputs import read_matches, read_pictures, read_plan
from vcage.runs.stage import Job, ModelOptions, StageResult, stage_seed
from vcage.schema.base import Provenance, box_record
from vcage.schema.matches import Match, Matches
from vcage.schema.plan import Plan
from vcage.schema.scene import Scene
from vcage.sim.drawer import ModelDrawer
from vcage.vision.match import THRESHOLD, Looks, Recogniser, match_picture
from vcage.vision.overlay import draw_overlay
from vcage.vision.symmetry import rotational_symmetry

logger = logging.getLogger(__name__)

LEAST_PLAN_SHARE = 0.7
"""Smallest share of the plan that a picture of it must show; with less, the result carries a note."""


def one_of_models(role: str, names: Sequence[str]) -> Callable[[str], str]:
    """Return a parser of ``NAME[:WEIGHTS]`` with one of some names; it raises ValueError that lists them."""

    def parse(text: str) -> str:
        if split_weights(text)[0] not in names:
            raise ValueError(f"no {role} is called {text!r}; there are: {', '.join(names)}")
        return text

    return parse


@dataclass(frozen=True, kw_only=True)
class Options(ModelOptions):
    """Options of finding objects and telling them apart."""

    detector: Annotated[
        str,
        value(one_of_models("detector", DETECTORS), "NAME[:WEIGHTS]"),
        arg(help=f"what finds objects in the target picture: {', '.join(DETECTORS)}; weights are a hub id or a folder"),
    ] = DETECTORS[0]
    embedder: Annotated[
        str,
        value(one_of_models("embedder", EMBEDDERS), "NAME[:WEIGHTS]"),
        arg(help=f"what tells them apart: {', '.join(EMBEDDERS)}"),
    ] = EMBEDDERS[0]
    threshold: Annotated[float, between(0, 1, "τ")] = THRESHOLD
    """smallest cosine similarity of a match without a label of the detector"""

    def context(self, run: RunFolder) -> StageContext:
        return StageContext(self.who(run), self.detector, self.embedder)


def job(run: RunFolder, options: Options, context: StageContext) -> Job:
    """Return the work of the stage."""
    return Job(
        run=run,
        output=run.matches,
        inputs=[
            run.scene,
            *(run.scene.parent / f"{name}.png" for name in ("source", "background", "segmentation")),
            run.plan,
            run.plan.parent / "target.png",
        ],
        seed=stage_seed(run, options.seed),
        options={"threshold": options.threshold},
        providers=context.models.providers("detector", "embedder"),
    )


def summary(record: Matches) -> dict[str, Any]:
    """Return a few facts for the caller."""
    kept = {m.object: m.note for m in record.matches if m.method == "kept"}
    return {
        "matched": len(record.matches) - len(kept),
        "of": len(record.matches),
        "kept": kept,
        "notes": record.notes,
        **record.checks,
    }


def execute(
    run: RunFolder, options: Options, context: StageContext, progress: Progress = silent
) -> StageResult[Matches]:
    """Write ``match/``: the matches and an overlay picture (paper, section III-A3)."""
    stage = job(run, options, context)

    def make(folder: Path, provenance: Provenance) -> Matches:
        scene = Scene.read(run.scene)
        plan = read_plan(run, scene, context)
        symmetries = {o.id: rotational_symmetry(context.reference(o)[0]) for o in scene.objects}
        found = match_picture(
            scene,
            plan,
            read_pictures(run, scene),
            read_picture(run.file(plan.target)),
            Recogniser(context.models.detector, context.models.embedder, options.threshold),
            Looks(symmetries, ModelDrawer(context.physical_models(scene))),
        )
        shown = _plan_in_picture(scene, plan, found.matches, context)
        notes = found.notes + _doubts(found.matches, shown)
        for note in notes:
            logger.warning("%s", note)
        write_picture(folder / "overlay.png", draw_overlay(found.picture, scene, found.matches, found.unclaimed))
        return Matches(
            provenance=provenance,
            threshold=options.threshold,
            matches=found.matches,
            unclaimed=found.unclaimed,
            overlay=stage.inside("overlay.png"),
            notes=notes,
            checks=_checks(shown),
        )

    return stage.do(Matches, make, force=options.force)


def _accept(edit: Edit[Matches]) -> Matches:
    """Check edited matches and measure them by the plan. The overlay shows the found matches, not the edits."""
    scene = Scene.read(edit.run.scene)
    matches = read_matches(edit.run, scene)
    shown = _plan_in_picture(scene, read_plan(edit.run, scene, edit.context), matches.matches, edit.context)
    return matches.model_copy(update={"checks": _checks(shown)})


EDITABLE = Editable(
    Matches, fields=("matches", "unclaimed", "threshold", "checks", "notes"), pictures=True, accept=_accept
)


def _plan_in_picture(scene: Scene, plan: Plan, matches: list[Match], context: StageContext) -> Kept:
    """Return the part of the plan that is true of the objects where they were matched."""
    boxes = {}
    for m in matches:
        record = scene.object(m.object)
        pose = Pose.from_yaw([*m.position, record.pose.position[2]], m.yaw)
        boxes[m.object] = box_record(context.asset(record).bounds, pose)
    return relations_kept(plan.relations, boxes, ground_box(scene.workspace, scene.table.height))


def _checks(shown: Kept) -> dict[str, Any]:
    return {"relations_shown": round(shown.share, 4), "relations_not_shown": shown.sentences}


def _doubts(matches: list[Match], shown: Kept) -> list[str]:
    """Return notes on a doubtful picture."""
    if all(m.method == "kept" for m in matches):
        return ["the target picture shows none of the scene's objects; all keep their place from the plan"]
    if shown.share < LEAST_PLAN_SHARE:
        return [f"the target picture shows only {shown.share:.0%} of the plan: {', '.join(shown.sentences)}"]
    return []
