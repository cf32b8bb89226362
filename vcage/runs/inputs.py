"""Read the files of earlier stages: schemas check each file by itself, this module checks it against the others."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from vcage.base.errors import InputFileError
from vcage.base.files import RunFolder
from vcage.base.pictures import read_labels, read_picture
from vcage.datasets.environment_state import StateLayout
from vcage.layout.capacities import size_complaints
from vcage.layout.items import TableItem
from vcage.plans.check import plan_complaints
from vcage.plans.descriptions import unsaid, with_descriptions
from vcage.plans.plain_words import in_words
from vcage.runs.context import StageContext
from vcage.runs.edits import refuse
from vcage.schema.matches import Matches
from vcage.schema.plan import LayoutPlan, Plan
from vcage.schema.scene import Scene
from vcage.vision.observation import ScenePictures

FARTHEST_M = 0.5
"""Distance beyond the table's edge up to which a matched position is to be optimised, and no damaged file."""


def read_plan(run: RunFolder, scene: Scene, context: StageContext) -> Plan:
    """Read ``inpaint/plan.json``, and check it against the scene.

    Raises:
        InputFileError: it is not possible in the scene; lists the complaints.
    """
    plan = Plan.read(run.plan)
    complaints = plan_check(scene, context.capacities(scene))(LayoutPlan(text=plan.text, relations=plan.relations))
    if complaints:
        raise InputFileError(
            f"{run.plan} is not possible: {'; '.join(complaints)}",
            hint="fix its relations",
            maker="inpaint_plan",
            details={"path": str(run.plan), "field": "relations", "problems": complaints},
        )
    return plan


def plan_check(scene: Scene, items: Mapping[str, TableItem]) -> Callable[[LayoutPlan], list[str]]:
    """Return a check of plans: it complains where the words of one contradict each other, the scene or its sizes."""
    return partial(plan_complaints, scene=scene, sizes=partial(size_complaints, items=items, workspace=scene.workspace))


def described_check(scene: Scene, items: Mapping[str, TableItem]) -> Callable[[LayoutPlan], list[str]]:
    """Return a :func:`plan_check` of plans to which the missing descriptions of the scene are added."""
    check, phrases = plan_check(scene, items), {o.id: o.phrase for o in scene.objects}

    def complaints(plan: LayoutPlan) -> list[str]:
        found = check(with_descriptions(plan, scene.laid_out, phrases))
        added = unsaid(plan.relations, scene.laid_out)
        if found and added:
            found.append(f"whatever else, this must be true: {'; '.join(in_words(d, phrases) for d in added)}")
        return found

    return complaints


def read_matches(run: RunFolder, scene: Scene) -> Matches:
    """Read ``match/matches.json``: one match for each object of the scene, not far from its table.

    Raises:
        InputFileError: it has other objects, or places far from the table.
    """
    matches = Matches.read(run.matches)
    ids, found = [o.id for o in scene.objects], [m.object for m in matches.matches]
    if sorted(ids) != sorted(found):
        wrong = sorted(set(ids) ^ set(found)) or sorted({name for name in found if found.count(name) > 1})
        raise InputFileError(
            f"{run.matches} has not one match for each object of the scene: see {', '.join(wrong)}",
            maker="match",
        )
    lower, upper = scene.table.rectangle + np.array([[-FARTHEST_M], [FARTHEST_M]])
    far = [m.object for m in matches.matches if np.any(m.position < lower) or np.any(m.position > upper)]
    if far:
        raise InputFileError(f"{run.matches} has places far from the table: {', '.join(far)}", maker="match")
    return matches


def read_pictures(run: RunFolder, scene: Scene) -> ScenePictures:
    """Read the pictures that ``scene.json`` names.

    Raises:
        MissingStage, DamagedFile: one is not there, or not a picture.
        InputFileError: one has not the size of the scene's camera.
    """
    for name in ("source", "segmentation", "background"):
        if name not in scene.pictures:
            refuse(run.scene, f"pictures.{name}", "nothing", "the path of a picture")
    read = {"source": read_picture, "segmentation": read_labels, "background": read_picture}
    pictures = {name: reader(run.file(scene.pictures[name])) for name, reader in read.items()}
    expected = (scene.top_camera.height, scene.top_camera.width)
    for name, picture in pictures.items():
        if picture.shape[:2] != expected:
            raise InputFileError(
                f"{run.file(scene.pictures[name])} has {picture.shape[1]} x {picture.shape[0]} pixels, the scene's "
                f"camera {expected[1]} x {expected[0]}",
                maker="select_place",
            )
    return ScenePictures(**pictures)


def state_layout(run: RunFolder, context: StageContext) -> StateLayout:
    """The order of the numbers of ``environment_state``, in the environment of a run and in exports of it.

    Raises:
        MissingStage, DamagedFile, SchemaMismatch: the run's layout cannot be read.
        UnknownName: the library lacks an object of it.
    """
    scene = Scene.read(run.layout)
    models = context.physical_models(scene)
    return StateLayout.of(scene, {name: len(model.links) for name, model in models.items()})
