"""Plan the layout in words and relations, and draw it as a target picture.

Reads place/. Writes inpaint/plan.json and inpaint/target.png.

examples:
  vcage inpaint-plan --run runs/stationery
  vcage inpaint-plan --run runs/stationery --models gemini --force
  vcage inpaint-plan --run runs/stationery --models agent --target edited.png --force
"""

from __future__ import annotations

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
from vcage.models.llm_editor import edit_complaint
from vcage.models.protocols import EditRequest
from vcage.plans.descriptions import with_descriptions
from vcage.runs.context import StageContext
from vcage.runs.edits import Edit, Editable
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
    """an edit of place/source.png made elsewhere, as the target picture"""


def job(run: RunFolder, options: Options, context: StageContext) -> Job:
    """Return the work of the stage."""
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
    """Return the hex SHA-256 of a picture file.

    Raises:
        InputFileError: it is missing, or not a readable picture.
    """
    if not path.exists():
        raise InputFileError(f"there is no picture {path}", hint="name an edit of place/source.png")
    picture_header(path)
    return sha256_file(path)


def summary(record: Plan) -> dict[str, Any]:
    """Return a few facts for the caller."""
    return {"text": record.text, "relations": len(record.relations), **record.checks, "notes": record.notes}


def execute(run: RunFolder, options: Options, context: StageContext, progress: Progress = silent) -> StageResult[Plan]:
    """Write ``inpaint/``: the plan L and the target picture.

    Raises:
        ModelRefused: the reasoner found no valid plan in its rounds (the message lists the complaints), or the editor
            refuses.
        InputFileError: the picture that was given is none, or no edit of the source.
        InfeasibleScene: the offline editor cannot show every object in the planned layout.
    """
    stage = job(run, options, context)

    def make(folder: Path, provenance: Provenance) -> Plan:
        scene = Scene.read(run.scene)
        check = described_check(scene, context.capacities(scene))
        said = context.models.reasoner.plan_layout(scene, context.catalogue, stage.rng(), check)
        said = with_descriptions(said, scene.laid_out, {o.id: o.phrase for o in scene.objects})
        plan = Plan(
            provenance=provenance,
            instruction=scene.instruction,
            text=said.text,
            relations=said.relations,
            target=stage.inside(TARGET),
        )
        request = _request(plan, read_pictures(run, scene), scene, context)
        if options.target is not None:
            write_picture(folder / TARGET, _edited_source(options.target, request))
        return _finished(plan, request, folder, context, is_drawn=options.target is not None)

    return stage.do(Plan, make, force=options.force)


def _finished(plan: Plan, request: EditRequest, folder: Path, context: StageContext, *, is_drawn: bool) -> Plan:
    """Return a plan with its figures; draw its target picture, unless it exists, and record who drew it."""
    layout = request.layout  # the solver's, for any editor
    found: dict[str, Any] = {
        "checks": {
            "relations_solvable": round(layout.kept.share, 4),
            "relations_unsolved": layout.kept.sentences,
            "overlapping": layout.overlapping,
        },
        "notes": [
            f"{name}: the source picture shows nothing of it, so the plan's picture cannot move it"
            for name in request.hidden
        ],
    }
    if not is_drawn:
        write_picture(folder / TARGET, context.models.editor.rearrange(request))
        providers = plan.provenance.providers | context.models.providers("editor")
        found["provenance"] = plan.provenance.model_copy(update={"providers": providers})
    return plan.model_copy(update=found)


def _edited_source(path: Path, request: EditRequest) -> np.ndarray:
    """Read a picture, which must be an edit of the source.

    Raises:
        InputFileError: it is not; states the measurements.
    """
    picture = read_picture(path)
    complaint = edit_complaint(picture, request.picture, request.background)
    if complaint:
        raise InputFileError(f"{path} is no edit of place/source.png: {complaint}", hint="edit that picture")
    return picture


def _accept(edit: Edit[Plan]) -> Plan:
    """Check a plan as the reasoner's is, or its picture as the editor's, and draw the picture unless it was edited."""
    scene = Scene.read(edit.run.scene)
    plan = read_plan(edit.run, scene, edit.context)
    request = _request(plan, read_pictures(edit.run, scene), scene, edit.context)
    if TARGET in edit.keep:
        _edited_source(edit.path.with_name(TARGET), request)
    return _finished(plan, request, edit.folder, edit.context, is_drawn=TARGET in edit.keep)


EDITABLE = Editable(Plan, fields=("text", "relations", "checks", "notes"), pictures=True, accept=_accept)


def _request(plan: Plan, pictures: ScenePictures, scene: Scene, context: StageContext) -> EditRequest:
    return EditRequest(
        picture=pictures.source,
        background=pictures.background,
        segmentation=pictures.segmentation,
        scene=scene,
        plan=LayoutPlan(text=plan.text, relations=plan.relations),
        items=context.capacities(scene),
    )
