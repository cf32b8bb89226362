"""Plan the layout in words and relations, and draw it as a target picture.

Reads place/. Writes inpaint/plan.json and inpaint/target.png.

examples:
  vcage inpaint-plan --run runs/stationery
  vcage inpaint-plan --run runs/stationery --models gemini --force
  vcage inpaint-plan --run runs/stationery --models agent --target edited.png --force
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from tyro.conf import arg

from vcage.base.errors import InputFileError
from vcage.base.files import RunFolder, sha256_file
from vcage.base.options import UNSAID
from vcage.base.pictures import picture_header, read_picture, write_picture
from vcage.base.progress import Progress, silent
from vcage.layout.items import TableItem
from vcage.models.llm_editor import edit_complaint
from vcage.models.protocols import EditRequest
from vcage.plans.descriptions import with_descriptions
from vcage.runs.context import StageContext
from vcage.runs.edits import refuse, require_same
from vcage.runs.inputs import described_check, read_pictures, read_plan
from vcage.runs.stage import Job, ModelOptions, StageResult, stage_seed
from vcage.schema.base import Provenance
from vcage.schema.plan import LayoutPlan, Plan
from vcage.schema.scene import Scene
from vcage.vision.observation import ScenePictures

TARGET = "target.png"
"""The picture, beside the plan."""

GIVEN = "file"
"""Provider of a picture that was edited elsewhere."""


@dataclass(frozen=True, kw_only=True)
class Options(ModelOptions):
    """Who draws."""

    target: Annotated[Path | None, arg(metavar="FILE"), UNSAID] = None
    """a target picture that was edited elsewhere from place/source.png, instead of one that the editor draws"""


def job(run: RunFolder, options: Options, context: StageContext) -> Job:
    """What the stage has to do."""
    folder = run.scene.parent
    given = options.target is not None
    return Job(
        run=run,
        output=run.plan,
        inputs=[run.scene, folder / "source.png", folder / "background.png", folder / "segmentation.png"],
        seed=stage_seed(run, options.seed),
        options={"target": _digest(options.target)} if options.target is not None else {},
        providers=context.models.providers("reasoner", "editor") | ({"editor": GIVEN} if given else {}),
    )


def _digest(path: Path) -> str:
    """Hex SHA-256 of a picture file.

    Raises:
        InputFileError: it is not there, or not a picture that can be read.
    """
    if not path.exists():
        raise InputFileError(f"there is no picture {path}", hint="name what was edited from place/source.png")
    picture_header(path)
    return sha256_file(path)


def summary(record: Plan) -> dict[str, Any]:
    """A few facts for whoever ran the stage."""
    return {"text": record.text, "relations": len(record.relations), **record.checks, "notes": record.notes}


def execute(run: RunFolder, options: Options, context: StageContext, progress: Progress = silent) -> StageResult[Plan]:
    """Write ``inpaint/``: the plan L and the target picture.

    Raises:
        ModelRefused: the reasoner was told what is wrong with its plan and found no better one in its rounds (the
            message lists the complaints), or the editor refuses.
        InputFileError: the picture that was given is none, or no edit of the source.
        InfeasibleScene: the offline editor cannot show every object in the planned layout.
    """
    stage = job(run, options, context)

    def make(folder: Path, provenance: Provenance) -> Plan:
        scene = Scene.read(run.scene)
        pictures = read_pictures(run, scene)
        items = context.capacities(scene)
        plan = context.models.reasoner.plan_layout(scene, context.catalogue, stage.rng(), described_check(scene, items))
        plan = with_descriptions(plan, scene.descriptions, {o.id: o.phrase for o in scene.objects})
        request = _request(scene, pictures, plan, items)
        target = context.models.editor.rearrange(request) if options.target is None else _given(options.target, request)
        write_picture(folder / TARGET, target)
        return Plan(
            provenance=provenance,
            instruction=scene.instruction,
            text=plan.text,
            relations=plan.relations,
            target=stage.inside(TARGET),
            checks=_solvable(request),
            notes=_notes(request),
        )

    return stage.do(Plan, make, force=options.force)


def _given(path: Path, request: EditRequest) -> np.ndarray:
    """The picture of a file, which must be an edit of the source.

    Raises:
        InputFileError: it is not; says what was measured.
    """
    picture = read_picture(path)
    complaint = edit_complaint(picture, request.picture, request.background)
    if complaint:
        raise InputFileError(f"{path} is no edit of place/source.png: {complaint}", hint="edit that picture")
    return picture


def take_over(run: RunFolder, folder: Path, edited: Collection[str], context: StageContext) -> Plan:
    """L as it was edited by hand; its picture is drawn again unless that was edited too.

    Raises:
        InputFileError: the plan is not possible, or the picture is none.
        ModelRefused: the editor refuses.
        InfeasibleScene: the offline editor cannot show every object in the planned layout.
    """
    require_same(run.plan, "instruction")
    scene = Scene.read(run.scene)
    plan = read_plan(run, scene, context)
    there = run.relative(run.plan.parent / TARGET)
    if plan.target != there:
        refuse(run.plan, "target", repr(plan.target), f"{there!r}, where the picture can be edited")
    if TARGET in edited:
        read_picture(run.file(there))
    if run.plan.name not in edited:
        return plan
    said = LayoutPlan(text=plan.text, relations=plan.relations)
    request = _request(scene, read_pictures(run, scene), said, context.capacities(scene))
    found: dict[str, Any] = {"checks": _solvable(request), "notes": _notes(request)}
    if TARGET not in edited:
        write_picture(folder / TARGET, context.models.editor.rearrange(request))
        drawn_by = plan.provenance.providers | context.models.providers("editor")
        found["provenance"] = plan.provenance.model_copy(update={"providers": drawn_by})
    return plan.model_copy(update=found)


def _request(scene: Scene, pictures: ScenePictures, plan: LayoutPlan, items: Mapping[str, TableItem]) -> EditRequest:
    return EditRequest(
        picture=pictures.source,
        background=pictures.background,
        segmentation=pictures.segmentation,
        scene=scene,
        plan=plan,
        items=items,
    )


def _solvable(request: EditRequest) -> dict[str, Any]:
    """How much of the plan the layout's solver can keep at once, whoever draws the picture."""
    layout = request.layout
    return {
        "relations_solvable": round(layout.kept.share, 4),
        "relations_unsolved": layout.kept.sentences,
        "overlapping": layout.overlapping,
    }


def _notes(request: EditRequest) -> list[str]:
    return [
        f"{name}: the source picture shows nothing of it, so the plan's picture cannot move it"
        for name in request.hidden
    ]
