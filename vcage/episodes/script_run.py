"""A run folder for one sub-task script, with its scene and sub-task in place of the earlier stages' files."""

from __future__ import annotations

from pathlib import Path

from vcage.base.errors import DamagedFile, UnknownName
from vcage.base.files import RunFolder, sha256_file, write_bytes
from vcage.base.geometry import Pose
from vcage.objects.library import Library
from vcage.runs.context import StageContext
from vcage.runs.edits import require_none
from vcage.runs.stage import Job
from vcage.scenes.possible import possible_scene
from vcage.scenes.possible_subtask import subtask_complaints
from vcage.schema.base import PoseRecord, Provenance, box_record
from vcage.schema.goals import goal_of
from vcage.schema.scene import ObjectRecord, Scene
from vcage.schema.subtasks import Chain, Grasp, Statement, StatementWord, Subtask, Subtasks
from vcage.sim.robots import load_template
from vcage.tasks.synthesis import Script, load_script

NEEDED = ("TEMPLATE", "ROBOT", "TEXT", "TEXTS", "SUBTASK", "SCENE", "GRASPS", "GOALS", "REQUIRES", "STATEMENTS")
HINT = "mend it, or search the sub-tasks of its run again"


def prepare_run(run: RunFolder, path: Path, *, seed: int, force: bool) -> None:
    """Write ``optimize/scene.json`` and ``subtasks/`` from the values of a script.

    Raises:
        StaleStage: the folder holds another scene or sub-task, and ``force`` is not set.
        DamagedFile: the script lacks a value that a generated one has.
        InputFileError: its scene or sub-task is not possible, see :mod:`~vcage.scenes.possible` and
            :mod:`~vcage.scenes.possible_subtask`.
    """
    script, context = load_script(path), StageContext()
    values = script.values
    missing = [name for name in NEEDED if name not in values]
    if missing:
        raise DamagedFile(f"{path} defines no {', '.join(missing)}", hint=HINT)
    origin = {"script": sha256_file(path)}
    layout = Job(run=run, output=run.layout, seed=seed, options=origin)

    def lay_out(_folder: Path, provenance: Provenance) -> Scene:
        scene = _scene(script, provenance, context)
        possible_scene(path, scene, context)
        return scene  # where it stood when the script was made, to the last digit

    scene = layout.do(Scene, lay_out, force=force).record
    search = Job(run=run, output=run.subtasks, inputs=[run.layout], seed=seed, options=origin)

    def make(folder: Path, provenance: Provenance) -> Subtasks:
        write_bytes(folder / path.name, path.read_bytes())
        subtask = _subtask(script, search.inside(path.name))
        require_none(path, subtask_complaints(subtask, "SUBTASK", scene, context.objects(scene)))
        return Subtasks(
            provenance=provenance,
            instruction=subtask.text,
            candidates=1,
            kept=[subtask],
            refused=[],
            chains=[Chain(text=subtask.text, subtasks=[subtask.id])],
        )

    search.do(Subtasks, make, force=force)


def _scene(script: Script, provenance: Provenance, context: StageContext) -> Scene:
    values = script.values
    try:
        template = load_template(values["TEMPLATE"], values["ROBOT"])
        return Scene(
            provenance=provenance,
            instruction=values["TEXT"],
            template=template.name,
            robot=template.robot,
            table=template.table,
            workspace=template.workspace,
            top_camera=template.top_camera,
            objects=[_object(key, fields, context.library) for key, fields in values["SCENE"].items()],
        )
    except (TypeError, ValueError, UnknownName) as error:
        raise _impossible(script, "scene", error) from error


def _object(key: str, fields: tuple, library: Library) -> ObjectRecord:
    asset, variant, role, phrase, position, quaternion, joints, container, *part = fields
    pose = Pose(position, quaternion)
    return ObjectRecord(
        id=key,
        asset=asset,
        variant=variant,
        phrase=phrase,
        role=role,
        pose=PoseRecord.of(pose),
        aabb=box_record(library.asset(asset, variant).bounds, pose),
        joints=joints,
        container=container,
        container_part=next(iter(part), None),
    )


def _subtask(script: Script, path: str) -> Subtask:
    values = script.values
    try:
        return Subtask(
            **values["SUBTASK"],
            id=script.path.stem,
            text=values["TEXT"],
            texts=values["TEXTS"],
            grasps=[Grasp(contact=contact, arm=arm, score=score) for contact, arm, score in values["GRASPS"]],
            requires=[goal_of(goal) for goal in values["REQUIRES"]],
            goals=[goal_of(goal) for goal in values["GOALS"]],
            statements=[_statement(*fields) for fields in values["STATEMENTS"]],
            script=path,
            checks=[],
        )
    except (TypeError, ValueError) as error:
        raise _impossible(script, "sub-task", error) from error


def _statement(subject: str, word: StatementWord, reference: str | None, part: str | None) -> Statement:
    return Statement(subject=subject, word=word, reference=reference, part=part)


def _impossible(script: Script, what: str, error: Exception) -> DamagedFile:
    return DamagedFile(f"{script.path} says of its {what} what cannot be: {' '.join(str(error).split())}", hint=HINT)
