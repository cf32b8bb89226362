"""The paper's tasks, each from its own sentence: how often every step and the whole succeed, by the simulator's state.

Each seed has a scene of its own, and in it a layout drawn as ``collect`` draws them (``--layout fixed``: as it was
optimised, with small shifts). There is no critic and no retry: an episode ends at its first failed step. A
task refused by the engine, in any stage, counts as failed with that reason.
"""

from __future__ import annotations

import argparse
import logging
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks._laying_out import lay_out
from vcage.base.errors import VcageError
from vcage.base.files import RunFolder
from vcage.episodes.starts import Starts
from vcage.evaluation import expert
from vcage.plans.actions import lasting
from vcage.runs.context import StageContext
from vcage.runs.inputs import read_plan
from vcage.runs.stage import ModelOptions
from vcage.schema.goals import Goal, in_steps
from vcage.schema.plan import Relation
from vcage.schema.randomisation import WorldRanges
from vcage.schema.robot import DEFAULT_ROBOT
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask, Subtasks
from vcage.stages import search_subtasks, select_place
from vcage.tasks.loop import EpisodeRun
from vcage.tasks.stowing import ready_for
from vcage.tasks.synthesis import Script, script_of

logger = logging.getLogger(__name__)

TASKS = {
    "PackBreads": "Pack three breads into the bread box",
    "PackStationery": "Collect three marker pens and a whiteboard eraser, and place them into the packaging box",
    "SortToCabinet": (
        "Open the top drawer of the cabinet, put the stapler in it and close it, "
        "then open the bottom drawer, put the pack of batteries in it and close it"
    ),
    "PickBlocks": "Pick four blocks and put them on the plate",
    "AutoCheckout": "Weigh the chocolate bar, scan it and show the payment sign to the customer",
}
"""Sentences for the tasks of the paper (section IV)."""

SEEDS = 20
FPS = 10


@dataclass
class Tally:
    """Outcome of a task.

    Args:
        steps, done: started steps, and the successful ones.
        whole: episodes with all steps successful and all goals true at the end.
        failures: how often, by reason.
    """

    steps: int = 0
    done: int = 0
    whole: int = 0
    failures: Counter[str] = field(default_factory=Counter)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("--robot", default=DEFAULT_ROBOT, help="which one (default: %(default)s)")
    parser.add_argument("--tasks", nargs="+", choices=TASKS, default=list(TASKS), help="which tasks")
    parser.add_argument("--layout", choices=("varied", "fixed"), default="varied", help="where objects start")


def run(
    quick: bool, robot: str = DEFAULT_ROBOT, tasks: Sequence[str] = tuple(TASKS), layout: str = "varied"
) -> dict[str, Any]:
    """A row for each task; reasons of failure go to the log.

    Args:
        quick: 3 seeds, not 20.
        robot: by name.
        tasks: names of :data:`TASKS`.
        layout: as of ``collect``.
    """
    context = StageContext("offline")
    seeds = 3 if quick else SEEDS
    return {"rows": [_row(name, TASKS[name], robot, layout, seeds, context) for name in tasks]}


def _row(name: str, sentence: str, robot: str, layout: str, seeds: int, context: StageContext) -> dict[str, Any]:
    tally, start = Tally(), time.perf_counter()
    for seed in range(seeds):
        try:
            _count(*simulated(sentence, seed, context, robot, layout), tally)
        except VcageError as error:
            tally.failures[f"refused: {error.message}"[:160]] += 1
    for reason, count in tally.failures.most_common(5):
        logger.info("%s: %d × %s", name, count, reason)
    return {
        "task": name,
        "robot": robot,
        "layout": layout,
        "seeds": seeds,
        "steps": tally.steps,
        "step_success": round(tally.done / tally.steps, 4) if tally.steps else 0.0,
        "whole_success": round(tally.whole / seeds, 4),
        "seconds": round((time.perf_counter() - start) / seeds, 2),
    }


def _count(chain: Sequence[Subtask], done: EpisodeRun, tally: Tally) -> None:
    """Add an episode of a chain to a tally."""
    for attempt in done.attempts:
        tally.steps += 1
        truth = attempt.truth
        if truth is not None and truth.success:
            tally.done += 1
        else:
            why = truth.reason if truth else attempt.reason
            tally.failures[f"{chain[attempt.step].template} at {attempt.stage}: {why}"[:160]] += 1
            return
    if done.goals_hold is not None and done.goals_hold.success:
        tally.whole += 1
    else:
        tally.failures[f"at the end: {done.goals_hold.reason if done.goals_hold else done.reason}"[:160]] += 1


@dataclass(frozen=True)
class Made:
    """A scene that the stages made of an instruction.

    Args:
        start: the scene at the start of the chain.
        chain: its sub-tasks, in order.
        relations: of the plan, for layouts that are drawn anew.
    """

    start: Scene
    chain: list[Subtask]
    relations: list[Relation]


def made(sentence: str, seed: int, context: StageContext, robot: str | None = None) -> Made:
    """The scene and the chain of an instruction, by the offline stages.

    Args:
        sentence: the instruction.
        seed: of all choices.
        context: the library.
        robot: by name; the scene's when not given.

    Raises:
        VcageError: a stage refuses.
    """
    with tempfile.TemporaryDirectory() as folder:
        run = RunFolder(Path(folder) / "run")
        begun = select_place.Options(instruction=sentence, models="offline", seed=seed, robot=robot)
        lay_out(run, begun, context)
        search_subtasks.execute(run, ModelOptions(models="offline"), context)
        scene, found = Scene.read(run.layout), Subtasks.read(run.subtasks)
        kept = {subtask.id: subtask for subtask in found.kept}
        chain = [kept[name] for name in found.chains[0].subtasks]
        start = ready_for(chain[0], scene, context.objects(scene))
        return Made(start, chain, read_plan(run, Scene.read(run.scene), context).relations)


def simulated(
    sentence: str, seed: int, context: StageContext, robot: str | None = None, layout: str = "fixed"
) -> tuple[list[Subtask], EpisodeRun]:
    """The chain of an instruction in a scene of its own, and one episode of it, without a critic.

    Args:
        sentence, seed, context, robot: as of :func:`made`.
        layout: as of ``collect``: drawn anew, or as optimised with small shifts.

    Raises:
        VcageError: a stage refuses.
    """
    scene = made(sentence, seed, context, robot)
    scripts = [(subtask, script_of(subtask)) for subtask in scene.chain]
    relations = scene.relations if layout == "varied" else None
    return scene.chain, play(scene.start, scripts, lasting(in_steps(scene.start.goals)), seed, context, relations)


def play(
    scene: Scene,
    chain: Sequence[tuple[Subtask, Script]],
    goals: Sequence[Goal],
    seed: int,
    context: StageContext,
    relations: Sequence[Relation] | None = None,
) -> EpisodeRun:
    """One episode of a chain, without a critic or retries.

    Args:
        scene: its start, except for the random draws.
        chain: sub-tasks with their scripts.
        goals: what must be true at the end.
        seed: of all choices.
        context: the library.
        relations: of the plan, for a layout drawn anew; without them objects are a little shifted.
    """
    starts = Starts(scene, relations, [subtask for subtask, _ in chain], WorldRanges(), context)
    return expert.play(starts.draw(np.random.default_rng([seed, 0])), chain, goals, FPS, seed=seed)
