"""Let the robot do the task, check every sub-task by looking, keep what is verified, record it.

Reads optimize/ and subtasks/. Writes episodes/*.hdf5, episodes/log.jsonl (every attempt) and episodes/rejected/.
Takes about 10 s per episode without a GPU; goes on where it stopped when run again.

examples:
  vcage collect --run runs/stationery --episodes 10
  vcage collect --run runs/stationery --episodes 100 --workers 2 --episode-limit 120
  vcage collect --run runs/stationery --episodes 10 --on-failure abort --force
"""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, lru_cache, partial
from pathlib import Path
from typing import Annotated, Any, Literal

from vcage.base.errors import PartlyDone
from vcage.base.files import RunFolder
from vcage.base.memory import free_memory
from vcage.base.options import NATURAL, POSITIVE, UNSAID
from vcage.base.progress import Progress, silent
from vcage.base.workers import Processes, ThisProcess, cores
from vcage.schema.episodes import Attempt, Episode, Episodes
from vcage.schema.subtasks import Subtasks
from vcage.stages.context import StageContext
from vcage.stages.episode_runner import EpisodeRunner
from vcage.stages.episode_store import EpisodeStore
from vcage.stages.stage import Job, ModelOptions, StageResult, stage_seed

logger = logging.getLogger(__name__)

OnFailure = Literal["resample", "abort"]

RUNS_PER_EPISODE = 3
"""Episodes that are tried for each that is wanted, before the collection gives up."""

OF_A_PROCESS = 1_000_000_000
"""Bytes of memory that there must be for a process that collects; measured, it takes half of them."""

SILENT, START = 1.5, 60.0
"""A process is taken to hang, and is ended, after this many times the limit of an episode and so many seconds for its
start: an episode that is merely slow ends itself before."""


@dataclass(frozen=True, kw_only=True)
class Options(ModelOptions):
    """How many episodes are collected, and how."""

    episodes: Annotated[int, POSITIVE] = 3
    """accepted episodes to collect"""
    on_failure: Annotated[OnFailure, UNSAID] = "resample"
    """after a failed sub-task: try it again from the verified state before it, or give the episode up"""
    retries: Annotated[int, NATURAL] = 3
    """further attempts per sub-task, when resampling"""
    fps: Literal[5, 10, 25, 50] = 10
    """frames per second of the recording"""
    workers: Annotated[int | None, POSITIVE, UNSAID] = None
    """processes that collect (default: as many as cores and memory allow; one more for a few episodes that these cannot
    share evenly)"""
    episode_limit: Annotated[float, POSITIVE] = 900.0
    """seconds after which an episode is given up"""


def job(run: RunFolder, options: Options, context: StageContext) -> Job:
    """What the stage has to do. The number of episodes is left out, as more can be added later, and so is what changes
    no episode: processes, and how long one may take."""
    scripts = []
    if run.subtasks.exists():
        record = Subtasks.read(run.subtasks)
        scripts = [run.root / s.script for s in record.kept if s.id in record.chain]
    return Job(
        run=run,
        output=run.episodes,
        inputs=[run.layout, run.subtasks, *scripts],
        seed=stage_seed(run, options.seed),
        options={"on_failure": options.on_failure, "retries": options.retries, "fps": options.fps},
        providers=context.models.providers("critic"),
    )


def summary(record: Episodes) -> dict[str, Any]:
    """A few facts for whoever ran the stage."""
    return {
        "accepted": sum(e.accepted for e in record.episodes),
        "rejected": sum(not e.accepted for e in record.episodes),
        "attempts": record.attempts,
        "silent_failures": sum(not e.goals_hold.success for e in record.episodes if e.accepted and e.goals_hold),
        "critic": record.critic,
    }


def execute(
    run: RunFolder, options: Options, context: StageContext, progress: Progress = silent
) -> StageResult[Episodes]:
    """Write ``episodes/``: one HDF5 per accepted episode, the log of all attempts, the rejected ones as states.

    Raises:
        MissingStage, StaleStage: see :class:`vcage.stages.stage.Job`.
        PartlyDone: no episode was accepted.
    """
    stage = job(run, options, context)
    stage.provenance()
    done = stage.finished(Episodes, force=options.force)
    if done is not None and _accepted(done.record.episodes) >= options.episodes:
        return done
    store = EpisodeStore(stage, Path(f"{run.episodes.parent}.collecting"))
    store.begin(done)
    _fill(store, options, context, progress)
    record = store.finish()
    accepted = _accepted(record.episodes)
    if accepted == 0:
        raise PartlyDone(
            f"none of {len(record.episodes)} episodes was verified: {record.episodes[-1].reason}",
            hint=f"see {run.episodes.parent / 'log.jsonl'}; another --seed gives another layout",
        )
    return StageResult(record, run.episodes, fresh=True, grown=done is not None, short=_shortfall(record, options))


def _shortfall(record: Episodes, options: Options) -> PartlyDone | None:
    """The error of a collection that has fewer verified episodes than were asked for; what it has is whole."""
    accepted, ran = _accepted(record.episodes), len(record.episodes)
    if accepted >= options.episodes:
        return None
    reasons = Counter(episode.reason for episode in record.episodes if not episode.accepted)
    return PartlyDone(
        f"asked for {options.episodes} episodes, verified {accepted} of the {ran} that were run: "
        f"{reasons.most_common(1)[0][0]}",
        hint="those that were verified are kept; another --seed gives another layout",
        details={"asked": options.episodes, "verified": accepted, "ran": ran, "reasons": dict(reasons.most_common(5))},
    )


def _accepted(episodes: Sequence[Episode]) -> int:
    return sum(episode.accepted for episode in episodes)


# --- as many episodes as are wanted --------------------------------------------------------------------


@dataclass(frozen=True)
class _Task:
    """An episode to be run: its number, and all that it depends on besides."""

    run: Path
    options: Options
    folder: Path
    index: int


_Done = tuple[Episode, list[Attempt]]


def _fill(store: EpisodeStore, options: Options, context: StageContext, progress: Progress) -> None:
    """Run episodes until as many as are wanted are accepted, or :data:`RUNS_PER_EPISODE` times as many were run.

    An episode depends on its number alone, they are kept in the order of their numbers, and none is begun that would
    not be needed if all that run are accepted: so the number of processes changes no file.
    """
    begun, finished = len(store.episodes), dict[int, _Done]()
    crew = _crew(options, options.episodes - _accepted(store.episodes), context)

    def submit() -> None:
        nonlocal begun
        needed = options.episodes - _accepted([*store.episodes, *(episode for episode, _ in finished.values())])
        running = begun - len(store.episodes) - len(finished)
        for _ in range(min(needed - running, RUNS_PER_EPISODE * options.episodes - begun)):
            crew.submit(_Task(store.run.root, options, store.folder, begun))
            begun += 1

    with crew:
        submit()
        progress(f"{len(store.episodes)} episodes run", _accepted(store.episodes), options.episodes)
        for done in crew.results():
            finished[done[0].index] = done
            while len(store.episodes) in finished:
                store.add(*finished.pop(len(store.episodes)))
            submit()
            if (accepted := _accepted(store.episodes)) < options.episodes:
                progress(f"{len(store.episodes)} episodes run", accepted, options.episodes)


def _crew(options: Options, wanted: int, context: StageContext) -> ThisProcess[_Task, _Done] | Processes[_Task, _Done]:
    """Who runs the episodes; one that does all works in this process, with what it has loaded already."""
    workers = min(options.workers or min(_enough(wanted), free_memory() // OF_A_PROCESS), wanted)
    if workers <= 1:
        runner = cache(partial(_runner, context=context))
        return ThisProcess(lambda task: runner(task.run, task.options).one(task.index, task.folder))
    return Processes(_in_process, workers, SILENT * options.episode_limit + START)


def _enough(wanted: int) -> int:
    """As many processes as there are cores; one more where a few episodes would leave some of these idle for long.

    Measured on two cores with three: three episodes of ``vcage run`` take a twelfth less, twelve a tenth more.
    """
    return cores() + (cores() < wanted < 2 * cores())


def _in_process(task: _Task) -> _Done:
    """Run an episode in a process of its own, which keeps what all episodes share."""
    return _shared(task.run, task.options).one(task.index, task.folder)


@lru_cache(maxsize=1)
def _shared(run: Path, options: Options) -> EpisodeRunner:
    return _runner(run, options, options.context())


def _runner(run: Path, options: Options, context: StageContext) -> EpisodeRunner:
    return EpisodeRunner(job(RunFolder(run), options, context), context, options.episode_limit)
