"""Sub-task scripts that a person runs: by themselves, each in a run folder of its own, or instead of generated ones."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path

from vcage.base.commands import joined
from vcage.base.errors import DamagedFile, InputFileError, UnknownName, UsageError
from vcage.base.files import RunFolder, sha256_file, write_bytes
from vcage.base.geometry import Pose
from vcage.base.placeholders import require_fetched
from vcage.objects.library import Library
from vcage.runs.context import StageContext
from vcage.runs.edits import edited_scripts, require_none
from vcage.runs.stage import Job
from vcage.scenes.possible import possible_scene
from vcage.scenes.possible_subtask import subtask_complaints
from vcage.schema.base import PoseRecord, Provenance, box_record
from vcage.schema.goals import goal_of
from vcage.schema.scene import ObjectRecord, Scene
from vcage.schema.subtasks import Chain, Grasp, Statement, StatementWord, Subtask, Subtasks
from vcage.sim.robots import load_template
from vcage.tasks.synthesis import Script, load_script
from vcage.tasks.templates import read_subtasks

NEEDED = ("TEMPLATE", "ROBOT", "TEXT", "TEXTS", "SUBTASK", "SCENE", "GRASPS", "GOALS", "REQUIRES", "STATEMENTS")
HINT = "fix it, or search the sub-tasks of its run again"


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
    asset, variant, role, phrase, position, quaternion, joints, container, *along = fields
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
        container_part=next(iter(along), None),
        heaped=along[1:] == [True],
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


# --- scripts in place of generated ones ----------------------------------------------------------------------


def named_scripts(run: RunFolder, paths: Sequence[Path]) -> dict[str, Path]:
    """Map sub-tasks to the scripts that are executed in place of the generated ones.

    Raises:
        InputFileError: there is no such file, or it is no regular file.
        UsageError: two are named for one sub-task.
        UnknownName: one is named after no sub-task of a chain.
    """
    found: dict[str, Path] = {}
    known = _chained(run) if paths else set()
    for path in paths:
        require_fetched(path)
        if not path.is_file():
            raise InputFileError(f"--script: there is no file {path}", hint="check the path")
        if path.stem not in known:
            raise UnknownName("sub-task with a script", path.stem, known)
        if path.stem in found:
            raise UsageError(f"--script: {found[path.stem]} and {path} are for the same sub-task", hint="name one")
        found[path.stem] = path
    return found


def _chained(run: RunFolder) -> set[str]:
    """Return the ids of the sub-tasks of all chains."""
    return {name for chain in read_subtasks(run.subtasks).chains for name in chain.subtasks}


def unnamed_edits(run: RunFolder, scripts: Collection[str]) -> list[str]:
    """Return a sentence on each edited script of a chain that is not executed."""
    folder, of_chains = run.subtasks.parent, _chained(run)
    return [
        f"{folder.name}/{name} was edited by hand and is not executed: its sub-task is carried out as "
        f"{run.subtasks.name} says; to execute it, add {joined(['--script', folder / name])}"
        for name in edited_scripts(run.subtasks)
        if Path(name).stem in of_chains and Path(name).stem not in scripts
    ]
