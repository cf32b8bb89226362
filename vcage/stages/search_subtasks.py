"""Search for sub-tasks that are sensible and proven feasible, and chain them for the instruction; without one, each is
a task of its own.

Reads optimize/scene.json. Writes subtasks/subtasks.json (kept and refused) and one script per kept sub-task.

examples:
  vcage search-subtasks --run runs/stationery
  python runs/stationery/subtasks/marker_black-into-packaging_box.py --episodes 2 --out runs/one
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from functools import partial
from itertools import repeat
from pathlib import Path
from typing import Any

import numpy as np

from vcage.base.attempts import LIMITS, GaveUp, first_accepted
from vcage.base.errors import NoFeasibleTask
from vcage.base.files import RunFolder
from vcage.base.progress import Progress, silent
from vcage.episodes.wordings import task_to_word, worded_chain
from vcage.plans.planner import Task, complaints
from vcage.runs.context import StageContext
from vcage.runs.edits import Complaint, Edit, Editable, require_none
from vcage.runs.stage import Job, ModelOptions, StageResult, stage_seed
from vcage.scenes.possible_subtask import subtask_complaints
from vcage.scenes.slot_choices import ready_objects, with_chosen_slots
from vcage.schema.base import Provenance
from vcage.schema.goals import in_steps
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Chain, Subtask, Subtasks
from vcage.tasks.asked_arms import asked_arms
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import FoundSubtasks, Judge, actions_of, compose, find_subtasks, initial_state
from vcage.tasks.stowing import ready_for
from vcage.tasks.synthesis import note_python, write_script
from vcage.tasks.templates import read_subtasks
from vcage.tasks.workplace import Workplace

Options = ModelOptions
"""The stage has no options of its own."""


def job(run: RunFolder, options: Options, context: StageContext) -> Job:
    """Return the work of the stage."""
    return Job(
        run=run,
        output=run.subtasks,
        inputs=[run.layout],
        seed=stage_seed(run, options.seed),
        providers=context.models.providers("reasoner"),
    )


def summary(record: Subtasks) -> dict[str, Any]:
    """Return a few facts for the caller."""
    return {
        "candidates": record.candidates,
        "kept": len(record.kept),
        "refused": len(record.refused),
        "chains": [chain.subtasks for chain in record.chains],
    }


def execute(
    run: RunFolder, options: Options, context: StageContext, progress: Progress = silent
) -> StageResult[Subtasks]:
    """Write ``subtasks/``: the kept and the refused, one runnable script per kept sub-task, the chain.

    Raises:
        NoFeasibleTask: no chain of kept sub-tasks fulfils the instruction, or without one none is kept; says why.
        ModelRefused: the reasoner gave no valid choice of grasps and places in its rounds.
        InfeasibleScene: the contents of one receptacle do not fit together, or a thing has no place on the table.
    """
    stage = job(run, options, context)

    def make(folder: Path, provenance: Provenance) -> Subtasks:
        scene, rng = Scene.read(run.layout), stage.rng()
        objects, reasoner = context.objects(scene), context.models.reasoner
        judge = partial(reasoner.judge_pairs, instruction=scene.instruction)

        found, chains = _search(scene, objects, judge, rng)
        by_id = {subtask.id: subtask for subtask in found.kept}
        steps = [[by_id[name] for name in chain.subtasks] for chain in chains]
        if scene.goals:
            chains = [worded_chain(*pair, scene, context, reasoner) for pair in zip(chains, steps, strict=True)]
        chosen = with_chosen_slots(steps, by_id, scene, objects, reasoner, rng)
        by_id |= {subtask.id: subtask for chain in chosen for subtask in chain}
        _write_scripts(by_id.values(), scene, objects, folder)
        return Subtasks(
            provenance=provenance,
            instruction=scene.instruction,
            candidates=found.candidates,
            kept=list(by_id.values()),
            refused=found.refused,
            chains=[
                chain.model_copy(update={"subtasks": [subtask.id for subtask in done]})
                for chain, done in zip(chains, chosen, strict=True)
            ],
        )

    return stage.do(Subtasks, make, force=options.force)


def _search(
    scene: Scene, objects: Sequence[SceneObject], judge: Judge, rng: np.random.Generator
) -> tuple[FoundSubtasks, list[Chain]]:
    """Sub-tasks, and the chain of the instruction. Places are drawn: where none is in reach, other ones are tried.

    Raises:
        NoFeasibleTask: no chain of kept sub-tasks fulfils the instruction, or without one none is kept; says why.
    """
    asked, arms = {one.goal for one in scene.goals}, asked_arms(scene.goals)

    def search() -> tuple[FoundSubtasks, list[Chain]]:
        found = find_subtasks(Workplace.of(scene, objects, rng), judge, asked, arms)
        return found, compose(scene, objects, found.kept, found.refused)

    try:
        return first_accepted(repeat(search, LIMITS.searches), NoFeasibleTask, LIMITS.same_searches).value
    except GaveUp as error:
        raise error.refusals[-1] from None


def _write_scripts(
    subtasks: Iterable[Subtask], scene: Scene, objects: Sequence[SceneObject], folder: Path, keep: Collection[str] = ()
) -> None:
    """Write the script of each sub-task, except those to keep."""
    note_python()
    for subtask in subtasks:
        if (name := f"{subtask.id}.py") not in keep:
            write_script(subtask, ready_for(subtask, scene, objects), folder / name)


def _accept(edit: Edit[Subtasks]) -> Subtasks:
    """Check edited sub-tasks and chains like those of the search, and write the unedited scripts.

    Raises:
        InputFileError: a sub-task is not one of this scene, or a chain does not bring about the goals.
    """
    record, scene = read_subtasks(edit.path), Scene.read(edit.run.layout)
    objects = edit.context.objects(scene)
    require_none(edit.path, _complaints(record, scene, objects, edit.context))
    _write_scripts(record.kept, scene, objects, edit.folder, edit.keep)
    words = {subtask.id: subtask.text for subtask in record.kept}
    return record.model_copy(
        update={
            "chains": [
                chain.model_copy(update={"text": scene.instruction or ", then ".join(words[n] for n in chain.subtasks)})
                for chain in record.chains
            ]
        }
    )


def _complaints(
    record: Subtasks, scene: Scene, objects: Sequence[SceneObject], context: StageContext
) -> Iterator[Complaint]:
    kept = {subtask.id: subtask for subtask in record.kept}
    for number, subtask in enumerate(record.kept):
        yield from subtask_complaints(subtask, f"kept.{number}", scene, objects)
        if subtask.script != (script := f"subtasks/{subtask.id}.py"):
            yield f"kept.{number}.script", repr(subtask.script), repr(script)
    for number, chain in enumerate(record.chains):
        steps, field = [kept[name] for name in chain.subtasks], f"chains.{number}"
        if chain in record.chains[:number]:
            yield field, "the same as another", "each chain once"
        if unproven := _unproven(steps, scene, objects):
            yield f"{field}.subtasks", "; ".join(unproven), "a chain that does what is asked, in order"
        task = task_to_word(steps, scene, context)
        for place, sentence in enumerate(chain.wordings):
            if unclear := task.complaints(sentence):
                wanted = f"a sentence that asks for the same in this scene: {'; '.join(unclear)}"
                yield f"{field}.wordings.{place}", repr(sentence), wanted


def _unproven(steps: Sequence[Subtask], scene: Scene, objects: Sequence[SceneObject]) -> list[str]:
    """Return complaints about a chain that does not achieve the goals of the scene, or else of its steps."""
    if scene.goals:
        task = Task(initial_state(objects), in_steps(scene.goals))
    else:
        ready = ready_objects(steps[0], scene, objects)
        task = Task(initial_state(ready), tuple(frozenset(step.goals) for step in steps))
    untouched = [f"{step.object} is to be left alone" for step in steps if step.object in scene.untouched]
    actions = actions_of(steps, objects, scene)
    return complaints(task, [actions[step.id] for step in steps]) + untouched


EDITABLE = Editable(
    Subtasks,
    fields=("candidates", "kept", "refused", "chains.#", "chains.*.subtasks", "chains.*.wordings"),
    pictures=True,
    accept=_accept,
)
