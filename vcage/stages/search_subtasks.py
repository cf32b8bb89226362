"""Search for sub-tasks that are sensible and proven feasible, and chain them for the instruction; without one, each is
a task of its own.

Reads optimize/scene.json. Writes subtasks/subtasks.json (kept and refused) and one script per kept sub-task.

examples:
  vcage search-subtasks --run runs/stationery
  python runs/stationery/subtasks/marker_black-into-packaging_box.py --episodes 2 --out runs/one
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from vcage.base.files import RunFolder
from vcage.base.progress import Progress, silent
from vcage.episodes.wordings import task_to_word, worded_chain
from vcage.plans.planner import Task, complaints
from vcage.runs.context import StageContext
from vcage.runs.edits import edited_scripts, refuse, written_record
from vcage.runs.stage import Job, ModelOptions, StageResult, stage_seed
from vcage.scenes.possible_subtask import require_possible
from vcage.scenes.slot_choices import with_chosen_slots
from vcage.schema.base import Provenance
from vcage.schema.goals import in_steps
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Chain, Subtasks
from vcage.tasks.asked_arms import asked_arms
from vcage.tasks.readiness import ready_for
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import action_of, compose, find_subtasks, initial_state
from vcage.tasks.synthesis import note_python, write_script
from vcage.tasks.workplace import Workplace

Options = ModelOptions
"""The stage has no options of its own."""


def job(run: RunFolder, options: Options, context: StageContext) -> Job:
    """What the stage has to do."""
    return Job(
        run=run,
        output=run.subtasks,
        inputs=[run.layout],
        seed=stage_seed(run, options.seed),
        providers=context.models.providers("reasoner"),
    )


def summary(record: Subtasks) -> dict[str, Any]:
    """A few facts for whoever ran the stage."""
    return {
        "candidates": record.candidates,
        "kept": len(record.kept),
        "refused": len(record.refused),
        "chains": [chain.subtasks for chain in record.chains],
    }


def execute(
    run: RunFolder, options: Options, context: StageContext, progress: Progress = silent
) -> StageResult[Subtasks]:
    """Write ``subtasks/``: what was kept and refused, one runnable script per kept sub-task, the chain.

    Raises:
        NoFeasibleTask: no chain of kept sub-tasks fulfils the instruction, or without one none is kept; says why.
        ModelRefused: the reasoner was told what is wrong with its choice of grasps and places and gave no better one.
        InfeasibleScene: what the chain puts into one receptacle does not fit together, or has no place on the table.
    """
    stage = job(run, options, context)

    def make(folder: Path, provenance: Provenance) -> Subtasks:
        scene, rng = Scene.read(run.layout), stage.rng()
        objects, reasoner = context.objects(scene), context.models.reasoner
        asked = {asked.goal for asked in scene.goals}
        by_goal, judge = asked_arms(scene.goals), partial(reasoner.judge_pairs, instruction=scene.instruction)
        found = find_subtasks(Workplace.of(scene, objects, rng), judge, asked, by_goal)
        chains = compose(scene, objects, found.kept, found.refused)
        by_id = {subtask.id: subtask for subtask in found.kept}
        steps = [[by_id[name] for name in chain.subtasks] for chain in chains]
        if scene.goals:
            chains = [worded_chain(*pair, scene, context, reasoner) for pair in zip(chains, steps, strict=True)]
        chosen = with_chosen_slots(steps, by_id, scene, objects, reasoner, rng)
        by_id |= {subtask.id: subtask for chain in chosen for subtask in chain}
        note_python()
        for subtask in by_id.values():
            write_script(subtask, ready_for(subtask, scene, objects), folder / f"{subtask.id}.py")
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


def take_over(run: RunFolder, folder: Path, edited: Collection[str], context: StageContext) -> Subtasks:
    """Sub-tasks and chains as they were edited by hand, with new scripts but for those that were edited too.

    Raises:
        InputFileError: a sub-task is about what there is not, or a chain does not bring about what is asked for.
    """
    record, scene = Subtasks.read(run.subtasks), Scene.read(run.layout)
    objects, by_hand = context.objects(scene), edited_scripts(run.subtasks)
    for number, subtask in enumerate(record.kept):
        require_possible(run.subtasks, f"kept.{number}", subtask, scene, objects)
        script = f"{subtask.id}.py"
        if subtask.script != run.relative(run.subtasks.with_name(script)):
            refuse(run.subtasks, f"kept.{number}.script", repr(subtask.script), repr(f"subtasks/{script}"))
        if script not in by_hand:
            write_script(subtask, ready_for(subtask, scene, objects), folder / script)
    if record.instruction != scene.instruction:
        refuse(run.subtasks, "instruction", repr(record.instruction), repr(scene.instruction))
    _require_proven(run.subtasks, record, scene, objects)
    _require_clear(run.subtasks, record, scene, context)
    return record.model_copy(update={"chains": _named(run.subtasks, record)})


def _named(path: Path, record: Subtasks) -> list[Chain]:
    """The chains with what they are called: the instruction, or the words of their steps, which may be new."""
    words = {subtask.id: subtask.text for subtask in record.kept}
    before = {chain.text for chain in written_record(path, Subtasks).chains}
    named = []
    for number, chain in enumerate(record.chains):
        text = record.instruction or ", then ".join(words[name] for name in chain.subtasks)
        if chain.text not in {text, *before}:
            refuse(path, f"chains.{number}.text", repr(chain.text), repr(text))
        named.append(chain.model_copy(update={"text": text}))
    return named


def _require_clear(path: Path, record: Subtasks, scene: Scene, context: StageContext) -> None:
    """Refuse wordings of a chain that do not ask for the goals of the scene, or name what is not clear in it."""
    kept = {subtask.id: subtask for subtask in record.kept}
    for number, chain in enumerate(record.chains):
        task = task_to_word([kept[name] for name in chain.subtasks], scene, context)
        for place, sentence in enumerate(chain.wordings):
            if complaints := task.complaints(sentence):
                wanted = f"a sentence that asks for the same in this scene: {'; '.join(complaints)}"
                refuse(path, f"chains.{number}.wordings.{place}", repr(sentence), wanted)


def _require_proven(path: Path, record: Subtasks, scene: Scene, objects: Sequence[SceneObject]) -> None:
    """That each chain brings about the goals of the scene, or without any those of its own steps."""
    kept = {subtask.id: subtask for subtask in record.kept}
    for number, chain in enumerate(record.chains):
        if chain in record.chains[:number]:
            refuse(path, f"chains.{number}", "the same as another", "each chain once")
        steps = [kept[name] for name in chain.subtasks]
        if scene.goals:
            task = Task(initial_state(objects), in_steps(scene.goals))
        else:
            joints = {o.id: o.joints for o in ready_for(steps[0], scene, objects).objects}
            ready = [o.moved(o.pose, joints[o.id]) for o in objects]
            task = Task(initial_state(ready), tuple(frozenset(step.goals) for step in steps))
        by_id = {o.id: o for o in objects}
        unproven = complaints(task, [action_of(step, by_id[step.object]) for step in steps])
        unproven += [f"{s.object} is to be left alone" for s in steps if s.object in scene.untouched]
        if unproven:
            refuse(path, f"chains.{number}.subtasks", "; ".join(unproven), "a chain that does what is asked, in order")
