"""A policy trained on an export of states, served, and evaluated by ``vcage evaluate`` in layouts never seen.

A small network (``benchmarks/_policy/network.py``) learns from the columns of an exported LeRobot data set: joints,
grippers, and poses of objects in the frames of the grippers. It is served behind openpi's protocol in a process of its
own, and evaluated through the command as any policy of a lab would be. The rows differ in their data: layouts drawn
for every episode, or the optimised layout with small shifts; all are evaluated on the same drawn layouts.

Episodes and weights are kept in ``--data``: an interrupted run collects and trains nothing twice, and evaluates anew.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import logging
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, get_args

import numpy as np

from benchmarks._policy.collected import Layout, Task, exported, task_objects
from benchmarks._policy.demonstrations import Demonstrations
from benchmarks._policy.training import Training, trained
from vcage.base.errors import UsageError, VcageError
from vcage.base.files import RunFolder, atomic_path, cache_dir

logger = logging.getLogger(__name__)

INSTRUCTION = "Put the block on the plate"
"""One sub-task, about four seconds long, among other things that stand about."""

ROBOT = "dual_panda"

LAYOUTS: tuple[Layout, ...] = get_args(Layout)


@dataclass(frozen=True)
class Plan:
    """Amount of work.

    Args:
        episodes: of training, of each row.
        seeds: trainings of each row.
        minutes: of each training.
        rollouts: of each policy.
    """

    episodes: int = 300
    seeds: int = 1
    minutes: float = 30.0
    rollouts: int = 100


QUICK = Plan(episodes=3, seeds=1, minutes=0.1, rollouts=1)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    for name, kind, what in (
        ("episodes", int, "of training, of each row"),
        ("seeds", int, "trainings of each row"),
        ("minutes", float, "of each training"),
        ("rollouts", int, "of each policy"),
    ):
        default = f"default: {getattr(Plan, name)}, with --quick {getattr(QUICK, name)}"
        parser.add_argument(f"--{name}", type=kind, help=f"{what} ({default})")
    parser.add_argument("--instruction", default=INSTRUCTION, help="the task (default: %(default)s)")
    parser.add_argument("--robot", default=ROBOT, help="who does it (default: %(default)s)")
    parser.add_argument("--layouts", default="varied,fixed", help="rows, with commas (default: %(default)s)")
    parser.add_argument("--data", type=Path, help="where episodes and weights are kept (default: the user's cache)")
    parser.add_argument("--workers", type=int, default=2, help="processes that collect and evaluate (default: 2)")


def run(
    quick: bool,
    instruction: str = INSTRUCTION,
    robot: str = ROBOT,
    layouts: str = "varied,fixed",
    data: Path | None = None,
    workers: int = 2,
    **chosen: Any,
) -> dict[str, Any]:
    """A row for each policy: its data, and its evaluation.

    - ``episodes``, ``frames``: that it was trained on; ``minutes``: of training, wall time.
    - all figures of ``vcage evaluate``: ``n_success`` of ``n_episodes``, ``pc_success_ci95`` (Wilson), ``furthest``
      (how far the episodes came), ``left_out`` (layouts in which the expert fails, too).

    Args:
        quick: a few episodes and seconds, which show that it runs, and nothing more.
        instruction: the task.
        robot: who does it.
        layouts: rows, with commas.
        data: where episodes and weights are kept.
        workers: processes.
        chosen: fields of :class:`Plan`.

    Raises:
        UsageError: a row that is none.
    """
    plan = replace(QUICK if quick else Plan(), **{k: v for k, v in chosen.items() if v is not None})
    rows = [layout for layout in LAYOUTS if layout in layouts.split(",")]
    if wrong := {*layouts.split(",")} - {*LAYOUTS}:
        raise UsageError(f"--layouts knows {', '.join(LAYOUTS)}, not {', '.join(sorted(wrong))}")
    folder = (data or cache_dir("benchmarks", "policy")) / robot / "-".join(instruction.lower().split())
    task = Task(instruction, robot, folder, workers)
    runs = {row: task.collected(plan.episodes, row) for row in rows}
    evaluated_in = runs.get("varied") or task.collected(plan.episodes, "varied")
    found = [
        _row(row, runs[row], evaluated_in, Training(minutes=plan.minutes, seed=seed), plan, task)
        for seed in range(plan.seeds)
        for row in rows
    ]
    return {"instruction": instruction, "robot": robot, "training": asdict(Training(plan.minutes)), "rows": found}


def _row(
    name: str, source: RunFolder, evaluated_in: RunFolder, training: Training, plan: Plan, task: Task
) -> dict[str, Any]:
    demonstrations = Demonstrations.read(exported(source), plan.episodes)
    made_from = hashlib.sha256(repr(training).encode())
    for numbers in (demonstrations.states, demonstrations.objects, demonstrations.actions):
        made_from.update(np.ascontiguousarray(numbers).data)
    weights = task.data / f"{name}-seed{training.seed}-{made_from.hexdigest()[:12]}.pt"
    if not weights.exists():
        logger.info("%s, seed %d: training for %g minutes", name, training.seed, training.minutes)
        with atomic_path(weights) as part:
            trained(demonstrations, task.robot, task_objects(source), training).write(part)
    facts = _evaluated(evaluated_in, weights, plan.rollouts, task.workers or 1)
    counts = {"episodes": len(demonstrations.ends), "frames": len(demonstrations.states)}
    return {"trained_on": name, "seed": training.seed, "minutes": training.minutes, **counts, **facts}


def _evaluated(run: RunFolder, weights: Path, rollouts: int, workers: int) -> dict[str, Any]:
    """Serve weights and evaluate them; the summary of ``vcage evaluate``."""
    with served(weights) as address:
        command = [sys.executable, "-m", "vcage.cli.main", "evaluate", str(run.root), "--policy", address]
        command += ["--episodes", str(rollouts), "--workers", str(workers), "--no-pictures", "--environment-state"]
        begun = time.perf_counter()
        out = run.root / "evaluations" / weights.stem
        done = subprocess.run([*command, "--out", str(out), "--force"], stdout=subprocess.PIPE, text=True)
    if done.returncode != 0:
        raise VcageError(f"vcage evaluate ended with {done.returncode}: {done.stdout[-500:]}")
    facts = json.loads(done.stdout.splitlines()[-1])["summary"]
    logger.info("%s: %s of %s in %.0f s", weights.stem, facts["n_success"], rollouts, time.perf_counter() - begun)
    return facts


@contextmanager
def served(weights: Path) -> Iterator[str]:
    """Serve a policy in a process of its own; its address."""
    command = [sys.executable, "-m", "benchmarks._policy.serve", str(weights)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        try:
            yield (server.stdout.readline() if server.stdout else "").strip()
        finally:
            server.terminate()
