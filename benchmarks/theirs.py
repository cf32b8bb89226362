"""The tasks of LIBERO and RoboTwin from their own sentences, on our robot.

Each task is told by its sentence, read by the grammar; one that is refused is told by its goals. A sentence that is
read as something else than its task is wrong, and is not run. A run plays one episode at which nothing is tried again.

``read`` are sentences that are read right, ``wrong`` those that are read wrongly. ``stated`` are tasks that can be
told, by sentence or by goals; ``by_goals`` those told by goals alone. ``feasible`` are tasks for which the robot found
a chain of sub-tasks with at least one seed. ``success`` is the share of all their runs whose goals hold at the end, by
the simulator's state; ``verified`` that of runs in which the critic said yes to every sub-task too. ``seconds`` is the
mean time of a run. ``motions`` counts the attempts at sub-tasks by template, and those in which the critic was wrong:
it accepted what is not so (``false_accepted``), or refused what is (``false_refused``).
"""

from __future__ import annotations

import argparse
import logging
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Final

from benchmarks._sentences.sources import Sentence
from benchmarks._sentences.whole import Ran, Whole, counts, ran
from benchmarks._theirs.reading import Found, found
from benchmarks._theirs.tasks import SUITES, Task, tasks
from vcage.base.errors import UsageError
from vcage.base.workers import cores, map_in_processes
from vcage.runs.context import StageContext
from vcage.tasks.templates import TEMPLATES

logger = logging.getLogger(__name__)

QUICK_TASKS = 12

FPS: Final = 5
"""Frames per second of a recording that nobody keeps: the state is watched at every step of the physics, and the critic
sees pictures of the moments between sub-tasks."""

REASON_CHARACTERS = 160

Told = Sequence[tuple[Task, Found]]
"""Tasks, and what is made of each."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of this benchmark."""
    parser.add_argument("--suite", choices=SUITES, help="one of them (default: both)")
    parser.add_argument("--seeds", type=int, default=5, help="runs of each task, with seeds from 0 on")
    parser.add_argument("--reading", action="store_true", help="count what is read and stated, and run nothing")
    parser.add_argument("--robot", help="which one (default: that of the scene)")
    parser.add_argument("--longest", type=float, default=600.0, metavar="S", help="seconds of a run at most")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="leave the run folders there; finished runs stay")
    parser.add_argument("--workers", type=int, default=cores(), help="processes")


def run(
    quick: bool,
    suite: str | None = None,
    seeds: int = 5,
    reading: bool = False,
    robot: str | None = None,
    longest: float = 600.0,
    keep: Path | None = None,
    workers: int = 1,
) -> dict[str, Any]:
    """A row for each suite, the commonest reasons of failure, and attempts; what is not read goes to the log.

    Args:
        quick: 12 tasks, 1 seed.
        suite: libero or robotwin; both when not given.
        seeds: runs of each task.
        reading: run nothing.
        robot: by name.
        longest: wall seconds of a run; one that takes longer has failed.
        keep: folder for the runs.
        workers: processes.

    Raises:
        UsageError: there is no seed.
    """
    if seeds < 1:
        raise UsageError("no seed leaves nothing to run", hint="give --seeds a number from 1 on")
    suites = [suite] if suite else SUITES
    context, most = StageContext("offline"), QUICK_TASKS // len(suites) if quick else None
    told = [(task, found(task, context)) for name in suites for task in chosen(name, most)]
    for task, one in told:
        if not one.read:
            logger.info("%s: %r: %s", task.suite, task.text, f"WRONG: {one.wrong}" if one.wrong else one.reason)
    counted = range(0 if reading else 1 if quick else seeds)
    wholes = [whole for seed in counted for whole in _runs(told, seed, robot, keep, context, longest)]
    done = []
    for one in map_in_processes(ran, wholes, workers):
        done.append(one)
        logger.info("[%d/%d] %s, seed %d: %s", len(done), len(wholes), one.sentence, one.seed, outcome(one))
    return figures(told, done)


def chosen(suite: str, most: int | None) -> list[Task]:
    """The tasks of a suite, or so many of them, evenly spread."""
    found = tasks(suite)
    return found if most is None else [found[place * len(found) // most] for place in range(most)]


def _runs(
    told: Told, seed: int, robot: str | None, keep: Path | None, context: StageContext, longest: float
) -> Iterable[Whole]:
    """A run of every task that can be told: the state alone ends it, so that it goes on where the critic is wrong."""
    for task, one in told:
        if one.told_by is not None:
            stated = task.options(context.catalogue) if one.told_by == "goals" else {}
            sentence = Sentence(task.text, task.id)
            yield Whole(
                sentence, seed, robot, keep, FPS, accept="state", on_failure="abort", longest_s=longest, **stated
            )


def outcome(one: Ran) -> str:
    """The outcome of a run in a few words."""
    if one.first_verified:
        return "verified"
    if one.first:
        return f"done, but the critic says no: {next(t.reason for t in one.tried if t.accepted is False)}"
    stage = "not feasible" if not one.templates else "failed"
    failed = next((f"{t.template} at {t.stage}: {t.truth or t.reason}" for t in one.tried if not t.true), one.reason)
    return f"{stage}: {failed}"


def figures(told: Told, done: Sequence[Ran]) -> dict[str, Any]:
    """The figures to print: a row for each suite, its commonest reasons of failure, and attempts by template."""
    suites = list(dict.fromkeys(task.suite for task, _ in told))
    rows, failures = [], []
    for suite in suites:
        of_it = [one for one in done if one.source.startswith(f"{suite}/")]
        rows.append(_row(suite, [one for task, one in told if task.suite == suite], of_it))
        reasons = Counter(outcome(one)[:REASON_CHARACTERS] for one in of_it if not one.first_verified)
        failures += [{"suite": suite, "count": n, "reason": reason} for reason, n in reasons.most_common(10)]
    tried = [attempt for one in done for attempt in one.tried]
    motions = [
        {"template": name, **counts(of_it)}
        for name in TEMPLATES
        if (of_it := [one for one in tried if one.template == name])
    ]
    more = {"failures": failures, "motions": motions}
    return {"rows": rows, **{name: found for name, found in more.items() if found}}


def _row(suite: str, told: Sequence[Found], done: Sequence[Ran]) -> dict[str, Any]:
    feasible = {one.source for one in done if one.templates}
    counted = [one for one in done if one.source in feasible]
    return {
        "suite": suite,
        "tasks": len(told),
        "read": sum(one.read for one in told),
        "wrong": sum(bool(one.wrong) for one in told),
        "by_goals": sum(one.told_by == "goals" for one in told),
        "stated": sum(one.told_by is not None for one in told),
        "feasible": len(feasible),
        "success": _share([one.first is True for one in counted]),
        "verified": _share([one.first_verified for one in counted]),
        "seconds": round(sum(one.seconds for one in done) / max(len(done), 1), 1),
    }


def _share(held: Sequence[bool]) -> float | None:
    return round(sum(held) / len(held), 4) if held else None
