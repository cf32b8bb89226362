"""Search for sub-tasks that are sensible and proven feasible, and chain them for the instruction; without one, each is
a task of its own.

Reads optimize/scene.json. Writes subtasks/subtasks.json (kept and refused) and one script per kept sub-task.

examples:
  vcage search-subtasks --run runs/stationery
  python runs/stationery/subtasks/marker_black-into-packaging_box.py --episodes 2 --out runs/one
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from vcage.base.files import RunFolder
from vcage.base.progress import Progress, silent
from vcage.schema.base import Provenance
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtasks
from vcage.sim.robots import load_robot
from vcage.stages.context import StageContext
from vcage.stages.stage import Job, ModelOptions, StageResult, stage_seed
from vcage.tasks.ground import Ground
from vcage.tasks.readiness import ready_for
from vcage.tasks.search import compose, find_subtasks
from vcage.tasks.slots import slots_for_chain
from vcage.tasks.synthesis import write_script

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
        InfeasibleScene: what the chain moves into one receptacle does not fit together.
    """
    stage = job(run, options, context)

    def make(folder: Path, provenance: Provenance) -> Subtasks:
        scene, rng = Scene.read(run.layout), stage.rng()
        objects, reasoner = context.objects(scene), context.models.reasoner
        asked = {asked.goal for asked in scene.goals}
        arms = context.kinematics(scene.robot)
        ground = Ground.of(scene)
        found = find_subtasks(objects, arms, reasoner.judge_pairs, ground, rng, asked)
        chains = compose(scene, objects, found.kept, found.refused)
        by_id = {subtask.id: subtask for subtask in found.kept}
        for chain in chains:
            slots_for_chain([by_id[i] for i in chain.subtasks], objects, load_robot(scene.robot), ground, rng)
        for subtask in found.kept:
            write_script(subtask, ready_for(subtask, scene, objects), folder / f"{subtask.id}.py")
        return Subtasks(
            provenance=provenance,
            instruction=scene.instruction,
            candidates=found.candidates,
            kept=found.kept,
            refused=found.refused,
            chains=chains,
        )

    return stage.do(Subtasks, make, force=options.force)
