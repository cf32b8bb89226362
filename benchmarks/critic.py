"""Count the critic's verdicts on outcomes of sub-tasks whose truth the simulator knows.

Half of the outcomes are successes, some of them ugly. The others failed, each in one of about twenty ways made
in the simulator, by the robot or by hand. Scenes are those of five templates and of the sentences that ``benchmarks
sentences`` runs whole. They are drawn until there are twenty successes and as many failures of each template of
sub-tasks, or the limit of draws is reached; the log then names the missing ones. The critic sees the same as during
collection.

``untouched`` outcomes are kept unseen while the offline critic is tuned: of two scenes, and of about
half of the kinds of objects that its unit tests do not show (drawn on 2026-11-26, ``_critic/scenes.py``). Precision and
recall stand with the lower end of their Wilson interval (95 %).

``paper_tasks`` is Table IV of the paper: of each of its tasks, the share of true episodes among all that came to their
end (``open_loop``), and among those in which the critic accepted each step (``closed_loop``); ``kept`` is the share of
the true ones that it accepted. ``--count`` chooses outcomes, tasks or both.

``--keep`` leaves the outcomes in a folder, for other critics; ``--pictures`` reads such a folder. Its folders and files
have neutral names, numbers drawn from the seed. ``outcomes.json`` lists only the questions, and ``truth.json`` alone
the truth, so a judge that does not open that is blind.
"""

from __future__ import annotations

import argparse
import logging
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks._critic import paper_tasks
from benchmarks._critic.making import outcomes
from benchmarks._critic.outcome import Outcome, OutcomeRecord, read_outcomes, write_list
from benchmarks._critic.quotas import Quotas, filled
from benchmarks._critic.scenes import SCENES, Draw, settings
from benchmarks._sentences.sources import by_template, slug
from vcage.base.errors import VcageError
from vcage.base.proportions import wilson
from vcage.base.workers import cores, map_in_processes
from vcage.episodes.question import Asking, verdict
from vcage.runs.context import StageContext
from vcage.schema.episodes import Verdict
from vcage.schema.robot import DEFAULT_ROBOT
from vcage.tasks.templates import TEMPLATES

logger = logging.getLogger(__name__)

DRAWS, SUBTASKS = 5, 12
"""Draws of each scene of a template, and sub-tasks that are carried out in each."""

ASKED = 3
"""Sub-tasks that are carried out in a scene of a sentence, which is drawn once."""

PARTS = ("tuning", "untouched", "all")
COUNTED = ("outcomes", "tasks")
EPISODES = 20
"""Episodes of each task of the paper."""

CONFIDENCES = (0.5, 0.7, 0.9, 1.0)
"""Edges between which stated confidences are counted together."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("--models", default="offline", help="whose critic: offline, or a provider")
    parser.add_argument("--robot", default=DEFAULT_ROBOT, help="which one (default: %(default)s)")
    parser.add_argument("--part", choices=PARTS, default="all", help="which outcomes are made")
    parser.add_argument("--templates", nargs="+", choices=TEMPLATES, help="only outcomes of these kinds of sub-tasks")
    parser.add_argument(
        "--count", nargs="+", choices=COUNTED, default=COUNTED, help="outcomes, the paper's tasks, or both"
    )
    parser.add_argument("--episodes", type=int, default=EPISODES, help="of each task of the paper (with --quick: 1)")
    parser.add_argument("--first", type=int, default=0, help="seed of the first draw of each scene")
    parser.add_argument(
        "--keep",
        type=Path,
        metavar="DIR",
        help="leave the outcomes there, with what is true of them in truth.json alone",
    )
    parser.add_argument("--pictures", type=Path, metavar="DIR", help="judge the outcomes that lie there")
    parser.add_argument("--workers", type=int, default=cores(), help="processes")


def run(
    quick: bool,
    models: str = "offline",
    robot: str = DEFAULT_ROBOT,
    part: str = "all",
    templates: Sequence[str] | None = None,
    count: Sequence[str] = COUNTED,
    episodes: int = EPISODES,
    first: int = 0,
    keep: Path | None = None,
    pictures: Path | None = None,
    workers: int = 1,
) -> dict[str, Any]:
    """Rows for each part, template and kind of outcome.

    Args:
        quick: about 100 outcomes, not 1000.
        models: whose critic.
        robot: by name.
        part: which outcomes are made.
        templates: kinds of sub-tasks; all when not given.
        count: some of :data:`COUNTED`.
        episodes: of each task of the paper.
        first: seed of the first draw of each scene.
        keep: folder for the outcomes.
        pictures: folder of outcomes to judge, none are made then.
        workers: processes.
    """
    found: dict[str, Any] = {"rows": []}
    if "outcomes" in count:
        chosen = tuple(templates or TEMPLATES)
        draws = None if pictures else [replace(d, templates=chosen) for d in drawn(first, robot, part, quick)]
        with tempfile.TemporaryDirectory() as temporary:
            found = _of_outcomes(pictures or keep or Path(temporary), draws, quick, models, workers)
    if "tasks" in count:
        tasks = paper_tasks.draws(1 if quick else episodes, robot, models)
        found["paper_tasks"] = paper_tasks.rows(list(map_in_processes(paper_tasks.ended, tasks, workers)))
    return found


def _of_outcomes(folder: Path, draws: Sequence[Draw] | None, quick: bool, models: str, workers: int) -> dict[str, Any]:
    """Figures of the outcomes in a folder, made there first where there are draws."""
    if draws is not None and quick:
        make(draws, folder, workers)
    elif draws is not None:
        filled(draws, lambda more, before: make(more, folder, workers, before), Quotas(templates=draws[0].templates))
    tasks = [_Task(folder, models, n, workers) for n in range(workers)]
    judged = [one for some in map_in_processes(_judged, tasks, workers) for one in some]
    judged.sort(key=lambda one: one.record.id)
    for one in judged:
        if one.wrong:
            logger.info("%s (%s): %s", one.record.id, one.record.name, one.told)
    return figures(judged, models)


def drawn(first: int, robot: str, part: str, quick: bool) -> list[Draw]:
    """The outcomes that are made in any case; see :func:`run`."""
    count, subtasks, asked = (1, 5, 2) if quick else (DRAWS, SUBTASKS, ASKED)
    of_templates = [Draw(scene, first + n, robot, subtasks, part) for n in range(count) for scene in SCENES]
    chosen = map(slug, dict.fromkeys(by_template().values())) if quick else (s for s in settings() if s not in SCENES)
    return [*of_templates, *(Draw(scene, first, robot, asked, part) for scene in chosen)]


def make(
    draws: Sequence[Draw], folder: Path, workers: int, before: Sequence[OutcomeRecord] = ()
) -> list[OutcomeRecord]:
    """Write outcomes to a folder, and the list of all that lie there.

    Args:
        draws: what they are of.
        folder: where they are written.
        workers: processes.
        before: outcomes that lie there already.

    Returns:
        The new ones.
    """
    records: list[OutcomeRecord] = []
    for made in map_in_processes(outcomes, draws, workers):
        for outcome in made:
            outcome.write(folder)
            records.append(outcome.record)
        logger.info("%d outcomes", len(before) + len(records))
        write_list(sorted([*before, *records], key=lambda record: record.id), folder)
    return records


@dataclass(frozen=True)
class _Task:
    """Every ``of``-th outcome of a folder, from one on."""

    folder: Path
    models: str
    first: int
    of: int


@dataclass(frozen=True)
class Judged:
    """An outcome and what the critic said of it.

    Args:
        record: the outcome.
        accepted, confidence, reason: the verdict; no, with the error, where there is none.
        seconds: it took.
    """

    record: OutcomeRecord
    accepted: bool
    confidence: float
    reason: str
    seconds: float

    @property
    def wrong(self) -> bool:
        """True if the verdict is not the truth."""
        return self.accepted != self.record.success

    @property
    def told(self) -> str:
        """Verdict and truth in one line."""
        said = "yes" if self.accepted else "no"
        return f"said {said} ({self.reason}), {self.record.kind}: {self.record.reason}"


def _judged(task: _Task) -> list[Judged]:
    context = StageContext(task.models)
    every = enumerate(read_outcomes(task.folder))
    return [judge(outcome, context) for number, outcome in every if number % task.of == task.first]


def judge(outcome: Outcome, context: StageContext) -> Judged:
    """Ask the critic of a context about one outcome."""
    record = outcome.record
    asking = Asking(record.text, record.goals, outcome.seen, outcome.empty, record.requires, record.grasped)
    start = time.perf_counter()
    try:
        said: Verdict | None = verdict(context, outcome.scene, asking)
        reason = said.reason  # pyrefly: ignore
    except VcageError as error:
        said, reason = None, error.message
    seconds = time.perf_counter() - start
    return Judged(record, said is not None and said.accepted, said.confidence if said else 0.0, reason, seconds)


def figures(judged: Sequence[Judged], critic: str = "offline") -> dict[str, Any]:
    """Precision and recall of each part, and where and how sure the wrong verdicts are."""
    rows = [_row(critic, part, [j for j in judged if part in ("all", j.record.part)]) for part in PARTS]
    return {
        "rows": rows,
        "by_template": _shares(judged, lambda j: j.record.template),
        "by_failure": _shares(judged, lambda j: j.record.kind),
        "by_confidence": _calibration(judged),
    }


def _row(critic: str, part: str, judged: Sequence[Judged]) -> dict[str, Any]:
    true = sum(j.accepted and j.record.success for j in judged)
    said, successes = sum(j.accepted for j in judged), sum(j.record.success for j in judged)
    precision, recall = _share(true, said), _share(true, successes)
    both = (precision or 0.0) + (recall or 0.0)
    return {
        "critic": critic,
        "part": part,
        "n": len(judged),
        "successes": successes,
        "precision": precision,
        "precision_low": round(wilson(true, said)[0], 4),
        "recall": recall,
        "recall_low": round(wilson(true, successes)[0], 4),
        "f1": round(2 * (precision or 0.0) * (recall or 0.0) / both, 4) if both else 0.0,
        "seconds": round(float(np.mean([j.seconds for j in judged])), 3) if judged else None,
    }


def _share(some: int, of: int) -> float | None:
    return round(some / of, 4) if of else None


def _shares(judged: Iterable[Judged], key: Any) -> dict[str, dict[str, int]]:
    """Count verdicts by a key: all, of successes, of failures, and the wrong ones, each way."""
    found: dict[str, Counter[str]] = defaultdict(Counter)
    for j in judged:
        done, yes, no = j.record.success, j.accepted and j.wrong, not j.accepted and j.wrong
        found[key(j)].update(n=1, successes=int(done), failures=int(not done), false_yes=int(yes), false_no=int(no))
    return {name: dict(counts) for name, counts in sorted(found.items())}


def _calibration(judged: Sequence[Judged]) -> dict[str, Any]:
    """Share of right verdicts, by stated confidence."""
    found = {}
    for low, high in zip((0.0, *CONFIDENCES[:-1]), CONFIDENCES, strict=True):
        some = [j for j in judged if low < j.confidence <= high or (low == 0.0 and j.confidence == 0.0)]
        if some:
            found[f"{low:g}-{high:g}"] = {"n": len(some), "right": _share(sum(not j.wrong for j in some), len(some))}
    return found
