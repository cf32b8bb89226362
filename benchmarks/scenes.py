"""The five scenes: how many of a scene's sub-tasks can be done from random places, and how many after the IGSC stages.

A scene's objects are drawn once; every seed puts them elsewhere at random, and lays them out from there. ``found`` are
the sub-tasks that are sensible for the objects and fit by size, wherever those stand. A sub-task succeeds with a seed
where it is feasible in the layout and its simulated episode does what it should, by the simulator's state: no critic
looks and nothing is tried again. ``valid`` is the share of those found that succeed with some seed, ``mean_success``
the mean over these of the share of seeds. Reasons of failure go to the log.
"""

from __future__ import annotations

import argparse
import logging
import tempfile
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.tasks import play
from vcage.base.errors import VcageError
from vcage.base.files import RunFolder
from vcage.base.workers import cores, map_in_processes
from vcage.models.selection_check import NamedObject
from vcage.plans.actions import lasting
from vcage.runs.context import StageContext
from vcage.runs.stage import ModelOptions
from vcage.scenes import placed_scene
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Refusal, Subtask, Subtasks
from vcage.sim.robots import load_template
from vcage.stages import inpaint_plan, match, optimize, search_subtasks, select_place
from vcage.tasks.search import sensible
from vcage.tasks.stowing import ready_for
from vcage.tasks.synthesis import script_of

logger = logging.getLogger(__name__)

SCENES = ("bathroom", "cabinet", "cashier_desk", "kitchen", "office_desk")
LAYOUTS = ("random", "igsc")
SEEDS = 5
SHOWN = 8
"""Reasons of failure that are logged for a layout, the most frequent ones."""

Outcome = dict[str, str]
"""Sub-task → why it failed with a seed; "" where it did not."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=SCENES, help="which ones")
    parser.add_argument("--robot", default="dual_panda", help="which one")
    parser.add_argument("--workers", type=int, default=cores(), help="processes")


def run(quick: bool, scenes: Sequence[str] = SCENES, robot: str = "dual_panda", workers: int = 1) -> dict[str, Any]:
    """Two rows for each scene: from random places, and laid out.

    Args:
        quick: two sub-tasks of a scene, with one seed.
        scenes: names of scene templates.
        robot: by name.
        workers: processes.
    """
    tasks = [_Task(scene, seed, robot, quick) for scene in scenes for seed in range(1 if quick else SEEDS)]
    tallies = {(scene, layout): Tally() for scene in scenes for layout in LAYOUTS}
    for task, outcomes in map_in_processes(_outcomes, tasks, workers):
        for layout, outcome in outcomes.items():
            tallies[task.scene, layout].add(outcome)
            done = sum(not reason for reason in outcome.values())
            logger.info("%s, seed %d, %s: %d of %d", task.scene, task.seed, layout, done, len(outcome))
    for (scene, layout), tally in tallies.items():
        for reason, count in tally.reasons().most_common(SHOWN):
            logger.info("%s, %s: %d × %s", scene, layout, count, reason[:200])
    return {
        "rows": [
            {"scene": s, "robot": robot, "layout": layout, **tally.row()} for (s, layout), tally in tallies.items()
        ]
    }


@dataclass
class Tally:
    """Outcomes of the sub-tasks of a scene in one kind of layout, with every seed."""

    outcomes: list[Outcome] = field(default_factory=list)

    def add(self, outcome: Outcome) -> None:
        """Count what came of one seed."""
        self.outcomes.append(outcome)

    def row(self) -> dict[str, Any]:
        """The figures of the benchmark."""
        names = list(self.outcomes[0]) if self.outcomes else []
        success = {name: float(np.mean([not outcome[name] for outcome in self.outcomes])) for name in names}
        valid = [share for share in success.values() if share > 0]
        return {
            "found": len(names),
            "valid": round(len(valid) / len(names), 4) if names else 0.0,
            "mean_success": round(float(np.mean(valid)), 4) if valid else 0.0,
        }

    def reasons(self) -> Counter[str]:
        """Counts by the sub-task's template and the reason."""
        return Counter(
            f"{name.partition(' ')[0]}: {reason}"
            for outcome in self.outcomes
            for name, reason in outcome.items()
            if reason
        )


@dataclass(frozen=True)
class _Task:
    """A scene with one seed, in both layouts."""

    scene: str
    seed: int
    robot: str
    quick: bool


@lru_cache(maxsize=1)
def _context() -> StageContext:
    return StageContext("offline")


def _outcomes(task: _Task) -> tuple[_Task, dict[str, Outcome]]:
    """Outcome of each sub-task, by layout."""
    context = _context()
    with tempfile.TemporaryDirectory() as folder:
        first = RunFolder(Path(folder) / "first")
        drawing = select_place.Options(template=task.scene, robot=task.robot, models="offline", seed=0)
        select_place.execute(first, drawing, context)
        drawn = Scene.read(first.scene)
        found = found_subtasks(drawn, context)
        names = [found[0], found[-1]] if task.quick else found
        outcomes = {}
        for layout in LAYOUTS:
            run = RunFolder(Path(folder) / layout)
            try:
                _lay_out(run, drawn, task.seed, layout, context)
                outcomes[layout] = _played(run, names, task.seed, context)
            except VcageError as error:
                outcomes[layout] = dict.fromkeys(names, f"refused: {error.message}")
    return task, outcomes


def found_subtasks(scene: Scene, context: StageContext) -> list[str]:
    """The sub-tasks that make sense for the objects of a scene and fit by size, wherever the objects stand."""
    proposals, _, _ = sensible(context.objects(scene), context.models.reasoner.judge_pairs)
    return list(dict.fromkeys(_name(proposal.refusal("as any other")) for proposal in proposals))


def _name(found: Subtask | Refusal) -> str:
    """Name of a sub-task, feasible or not."""
    goal = found.goals[0] if isinstance(found, Subtask) else found.goal
    return f"{found.template} {goal} {found.functional_point}"


def _lay_out(run: RunFolder, drawn: Scene, seed: int, layout: str, context: StageContext) -> None:
    """Write ``place/`` and ``optimize/`` of a run: the objects of a scene at other places, and where they end."""
    kept = {name: getattr(drawn, name) for name in Scene.model_fields if name not in ("objects", "checks", "schema_id")}
    objects = [NamedObject(o.id, o.asset, o.variant, o.phrase, o.role, o.container) for o in drawn.objects]
    rng, template = np.random.default_rng([seed, 1]), load_template(drawn.template, drawn.robot)
    placed = placed_scene.place_until_stable(kept, objects, template, context, rng)
    run.scene.parent.mkdir(parents=True)
    if layout == "random":
        placed.write(run.layout)
        return
    placed_scene.photograph(placed, context, run.scene.parent).write(run.scene)
    inpaint_plan.execute(run, inpaint_plan.Options(models="offline", seed=seed), context)
    match.execute(run, match.Options(models="offline", seed=seed), context)
    optimize.execute(run, optimize.Options(seed=seed), context)


def _played(run: RunFolder, names: Sequence[str], seed: int, context: StageContext) -> Outcome:
    """Carry out each sub-task in the layout of a run."""
    search_subtasks.execute(run, ModelOptions(models="offline", seed=seed), context)
    scene, searched = Scene.read(run.layout), Subtasks.read(run.subtasks)
    kept = {_name(subtask): subtask for subtask in searched.kept}
    return {
        name: _failure(kept[name], scene, seed, context) if name in kept else _refusal(name, searched) for name in names
    }


def _failure(subtask: Subtask, scene: Scene, seed: int, context: StageContext) -> str:
    """Why a simulated episode of a sub-task does not do what it should; "" where it does."""
    start = ready_for(subtask, scene, context.objects(scene))
    chain = [(subtask, script_of(subtask))]
    try:
        done = play(start, chain, lasting([subtask.goals]), seed, context)
    except VcageError as error:
        return f"refused: {error.message}"
    attempt = done.attempts[-1]
    if attempt.truth is None or not attempt.truth.success:
        return f"at {attempt.stage}: {attempt.truth.reason if attempt.truth else attempt.reason}"
    return "" if done.goals_hold and done.goals_hold.success else "it does not last"


def _refusal(name: str, searched: Subtasks) -> str:
    """Why a sub-task is not feasible in a layout."""
    reasons = [refusal.reason for refusal in searched.refused if _name(refusal) == name]
    return f"not feasible: {reasons[-1] if reasons else 'no reason given'}"
