"""The five scenes: their sub-tasks, and a task of several steps, from three kinds of layouts (Table III of the paper).

A scene's objects are drawn once. For every seed a task is drawn of goals that can be achieved in a layout which is not
compared, one by one, and three layouts are made:

- ``naive``, the paper's baseline: boxes without collision anywhere in the workspace, at any heading, blind to the arms'
  reach, to the camera's view, to fronts, and to the task. The objects stay as they come to rest.
- ``unplanned``: this project's placement, which knows reach, view and fronts, without a plan.
- ``igsc``: from there through the plan, its picture, the matching, and the optimisation, which tests the whole task.

``found`` are the sub-tasks that are sensible for the objects and fit by size, wherever those stand. A sub-task succeeds
with a seed where it is feasible in the layout and its simulated episode does what it should, by the simulator's state:
no critic looks and nothing is tried again. Per row:

- ``valid``: the share of those found that succeed with some seed; ``mean_success``: the mean over these of the share of
  seeds; ``success``: the share of all tries, sub-task by seed, that succeed.
- ``attempts``: tries for each success. ``robot_seconds``: simulated seconds for each success, with those of failures.
- ``chain``: the share of seeds with a layout from which the drawn task is feasible as a whole, each step where those
  before it leave things.

Reasons of failure go to the log.
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

from benchmarks._scenes.layouts import LAYOUTS, laid_out
from benchmarks._scenes.tasks import Played, drawn_task, found_subtasks, played, possible_goals, subtask_name
from vcage.base.errors import InfeasibleScene, NoFeasibleTask, VcageError
from vcage.base.files import RunFolder
from vcage.base.workers import cores, map_in_processes
from vcage.runs.context import StageContext
from vcage.schema.robot import DEFAULT_ROBOT
from vcage.schema.scene import Scene
from vcage.stages import select_place
from vcage.tasks.proven_chain import require_chain

logger = logging.getLogger(__name__)

SCENES = ("bathroom", "cabinet", "cashier_desk", "kitchen", "office_desk")
SEEDS = 5
QUICK = 2
"""Sub-tasks of each scene with ``--quick``."""

SHOWN = 8
"""Reasons of failure that are logged for a layout, the most frequent ones."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=SCENES, help="which ones")
    parser.add_argument("--robot", default=DEFAULT_ROBOT, help="which one (default: %(default)s)")
    parser.add_argument("--seeds", type=int, default=SEEDS, help="how many, from 0 on (with --quick: 1)")
    parser.add_argument("--subtasks", type=int, help="sub-tasks of each scene, drawn at random (default: all)")
    parser.add_argument("--workers", type=int, default=cores(), help="processes")


def run(
    quick: bool,
    scenes: Sequence[str] = SCENES,
    robot: str = DEFAULT_ROBOT,
    seeds: int = SEEDS,
    subtasks: int | None = None,
    workers: int = 1,
) -> dict[str, Any]:
    """Three rows for each scene: naive, unplanned, and laid out.

    Args:
        quick: two sub-tasks of a scene, with one seed.
        scenes: names of scene templates.
        robot: by name.
        seeds: how many.
        subtasks: how many of each scene, drawn at random; all where none is given.
        workers: processes.
    """
    most = QUICK if quick else subtasks
    tasks = [_Task(scene, seed, robot, most) for scene in scenes for seed in range(1 if quick else seeds)]
    tallies = {(scene, layout): Tally() for scene in scenes for layout in LAYOUTS}
    for task, outcomes in map_in_processes(_outcomes, tasks, workers):
        for layout, outcome in outcomes.items():
            tallies[task.scene, layout].add(outcome)
            done, said = sum(not one.reason for one in outcome.played.values()), outcome.chain or "feasible"
            told = (task.scene, task.seed, layout, done, len(outcome.played), said[:200])
            logger.info("%s, seed %d, %s: %d of %d; the task: %s", *told)
    for (scene, layout), tally in tallies.items():
        for reason, count in tally.reasons().most_common(SHOWN):
            logger.info("%s, %s: %d × %s", scene, layout, count, reason[:200])
    return {
        "rows": [
            {"scene": s, "robot": robot, "layout": layout, **tally.row()} for (s, layout), tally in tallies.items()
        ]
    }


@dataclass(frozen=True)
class Outcome:
    """Results from one layout.

    Args:
        played: by sub-task.
        chain: why the drawn task is not feasible as a whole; "" where it is.
    """

    played: dict[str, Played]
    chain: str


@dataclass
class Tally:
    """Outcomes of a scene in one kind of layout, with every seed."""

    outcomes: list[Outcome] = field(default_factory=list)

    def add(self, outcome: Outcome) -> None:
        """Count what came of one seed."""
        self.outcomes.append(outcome)

    def row(self) -> dict[str, Any]:
        """The figures of the benchmark."""
        names = list(self.outcomes[0].played) if self.outcomes else []
        share = {name: float(np.mean([not o.played[name].reason for o in self.outcomes])) for name in names}
        valid = [one for one in share.values() if one > 0]
        every = [one for outcome in self.outcomes for one in outcome.played.values()]
        done = sum(not one.reason for one in every)
        return {
            "found": len(names),
            "seeds": len(self.outcomes),
            "valid": round(len(valid) / len(names), 4) if names else 0.0,
            "mean_success": round(float(np.mean(valid)), 4) if valid else 0.0,
            "success": round(done / len(every), 4) if every else 0.0,
            "attempts": round(len(every) / done, 2) if done else None,
            "robot_seconds": round(sum(one.seconds for one in every) / done, 2) if done else None,
            "chain": round(float(np.mean([not o.chain for o in self.outcomes])), 4) if self.outcomes else 0.0,
        }

    def reasons(self) -> Counter[str]:
        """Counts by the sub-task's template and the reason."""
        return Counter(
            f"{name.partition(' ')[0]}: {one.reason}"
            for outcome in self.outcomes
            for name, one in outcome.played.items()
            if one.reason
        )


@dataclass(frozen=True)
class _Task:
    """A scene with one seed, in every layout; ``subtasks`` is the number of those that are tried, or None for all."""

    scene: str
    seed: int
    robot: str
    subtasks: int | None


@lru_cache(maxsize=1)
def _context() -> StageContext:
    return StageContext("offline")


def _outcomes(task: _Task) -> tuple[_Task, dict[str, Outcome]]:
    """Outcomes by layout."""
    context = _context()
    with tempfile.TemporaryDirectory() as folder:
        first = RunFolder(Path(folder) / "first")
        drawing = select_place.Options(template=task.scene, robot=task.robot, models="offline", seed=0)
        select_place.execute(first, drawing, context)
        drawn = Scene.read(first.scene)
    found, possible = found_subtasks(drawn, context), possible_goals(drawn, context)
    asked = drawn_task(possible, context.objects(drawn), np.random.default_rng([task.seed, 3]))
    names = list(dict.fromkeys(map(subtask_name, found)))
    if task.subtasks is not None:  # the same ones with every seed
        names = [names[int(n)] for n in sorted(np.random.default_rng(0).permutation(len(names))[: task.subtasks])]
    return task, {layout: _outcome(layout, drawn.model_copy(update=asked), names, task, context) for layout in LAYOUTS}


def _outcome(layout: str, drawn: Scene, names: Sequence[str], task: _Task, context: StageContext) -> Outcome:
    """Outcome of one layout of a scene with its task."""
    try:
        scene = laid_out(layout, drawn, task.seed, context)
    except VcageError as error:
        refused = f"refused: {error.message}"
        return Outcome(dict.fromkeys(names, Played(refused)), refused)
    return Outcome(played(scene, names, task.seed, context), _infeasible(scene, task.seed, context))


def _infeasible(scene: Scene, seed: int, context: StageContext) -> str:
    """Why the task of a scene is not feasible from its layout; "" where it is."""
    try:
        require_chain(scene, context.objects(scene), np.random.default_rng([seed, 4]))
    except (NoFeasibleTask, InfeasibleScene) as error:
        return error.message
    return ""
