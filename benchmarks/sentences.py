"""Ordinary sentences run whole: the examples on our own pages, and LIBERO's feasible ones.

Each is run as ``vcage run SENTENCE --episodes 1 --models offline`` runs it, up to the verification. The pages are read
when the benchmark runs (README.md, docs/, skills/), so it follows them. Attempts are counted under the kind of sub-task
(template) of the attempt. A sentence counts under each template of its chain; one refused before there is a
chain, under ``refused``; under ``all`` each counts once. ``exit_0`` are sentences that end with exit code 0.
``true`` are attempts that the simulator's state calls a success, ``accepted`` those with a yes of the critic:
``false_accepted`` are not true, ``false_refused`` are true and not accepted. ``wrong_episodes`` are sentences with
an accepted episode in which a goal does not hold at the end. ``seconds`` is the mean time of a sentence.
"""

from __future__ import annotations

import argparse
import logging
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from benchmarks._sentences.sources import Sentence, by_template, sentences
from benchmarks._sentences.whole import Ran, Tried, Whole, counts, ran
from vcage.base.errors import UsageError
from vcage.base.workers import cores, map_in_processes
from vcage.tasks.templates import TEMPLATES

logger = logging.getLogger(__name__)

REFUSED = "refused"
"""Stands for a template where a sentence is refused before there is a chain."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of this benchmark."""
    parser.add_argument("--seeds", type=int, default=1, help="runs of each sentence, with seeds from 0 on")
    parser.add_argument("--robot", help="which one (default: that of the scene)")
    parser.add_argument("--only", default="", metavar="SUBSTRING", help="sentences that have this in them")
    parser.add_argument(
        "--keep", type=Path, metavar="DIR", help="leave the run folders there; a sentence that is finished there stays"
    )
    parser.add_argument("--workers", type=int, default=cores(), help="processes")


def run(
    quick: bool,
    seeds: int = 1,
    robot: str | None = None,
    only: str = "",
    keep: Path | None = None,
    workers: int = 1,
) -> dict[str, Any]:
    """Rows by template, and what came of each sentence.

    Args:
        quick: one sentence of each template.
        seeds: runs of each sentence.
        robot: by name.
        only: text that a sentence must contain, in any case.
        keep: folder for the runs.
        workers: processes.

    Raises:
        UsageError: no sentence is left.
    """
    if seeds < 1:
        raise UsageError("no seed leaves nothing to run", hint="give --seeds a number from 1 on")
    tasks = [Whole(s, seed, robot, keep) for seed in range(seeds) for s in chosen(quick, only)]
    done = []
    for one in map_in_processes(ran, tasks, workers):
        done.append(one)
        for line in told(one):
            logger.info("[%d/%d] %s", len(done), len(tasks), line)
    place = {(task.sentence.text, task.seed): number for number, task in enumerate(tasks)}
    return figures(sorted(done, key=lambda one: place[one.sentence, one.seed]))


def chosen(quick: bool, only: str = "") -> list[Sentence]:
    """The sentences to run.

    Raises:
        UsageError: there are none.
    """
    wanted = set(by_template().values())
    found = [s for s in sentences() if only.lower() in s.text.lower() and (not quick or s.text in wanted)]
    if not found:
        raise UsageError(f"no sentence has {only!r} in it", hint="leave out --only, or --quick")
    return found


def told(one: Ran) -> list[str]:
    """A line about a sentence, and one for each verdict that is not the truth."""
    name = f"{one.sentence!r}, seed {one.seed}"
    lines = [f"{name}: exit {one.exit_code}, {one.seconds:.0f} s{f': {one.reason}' if one.reason else ''}"]
    for tried in one.tried:
        if tried.false_accepted or tried.false_refused:
            how = "FALSELY ACCEPTED" if tried.false_accepted else "falsely refused"
            lines.append(f"{name}: {tried.subtask} {how}: {tried.reason}; by the state: {tried.truth}")
    if one.wrong_episode:
        lines.append(f"{name}: WRONG EPISODE: {one.wrong_episode}")
    return lines


def figures(done: Sequence[Ran]) -> dict[str, Any]:
    """The figures to print: rows by template and of all, and each sentence."""
    rows = []
    for name in [*TEMPLATES, REFUSED]:
        of_it = [one for one in done if name in (one.templates or [REFUSED])]
        if of_it:
            rows.append(_row(name, of_it, lambda tried, name=name: tried.template == name))
    rows.append(_row("all", done, lambda _: True))
    return {"rows": rows, "sentences": [_sentence(one) for one in done]}


def _row(name: str, done: Sequence[Ran], is_of_it: Callable[[Tried], bool]) -> dict[str, Any]:
    return {
        "template": name,
        "sentences": len(done),
        "exit_0": sum(one.exit_code == 0 for one in done),
        **counts([tried for one in done for tried in one.tried if is_of_it(tried)]),
        "wrong_episodes": sum(bool(one.wrong_episode) for one in done),
        "seconds": round(sum(one.seconds for one in done) / max(len(done), 1), 1),
    }


def _sentence(one: Ran) -> dict[str, Any]:
    return {
        "sentence": one.sentence,
        "source": one.source,
        "seed": one.seed,
        "exit_code": one.exit_code,
        "templates": " ".join(one.templates),
        **counts(one.tried),
        "wrong_episode": one.wrong_episode,
        "seconds": one.seconds,
        "reason": one.reason,
    }
