"""One job: a run folder through the whole chain in this process, counted, timed, and settled once."""

from __future__ import annotations

import contextlib
import errno
import logging
import os
import platform
import resource
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from vcage.base.errors import (
    ConfigurationError,
    DiskFull,
    MissingStage,
    NotJudged,
    OutputFolderError,
    PartlyDone,
    PassingFault,
    TooFewVerified,
    VcageError,
)
from vcage.base.files import NO_ROOM, RunFolder
from vcage.base.leftovers import PARTIAL
from vcage.base.memory import largest_memory, measure_memory_anew
from vcage.base.progress import Progress
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.plan import Job, Plan
from vcage.campaigns.record import JobError, JobRecord, State, Tries
from vcage.episodes.quota import Wanted
from vcage.models.shared import Shared
from vcage.models.spending import Cap
from vcage.runs.accepted import no_episode_counts, refusals
from vcage.runs.context import StageContext
from vcage.schema.episodes import Episodes
from vcage.schema.subtasks import Subtasks
from vcage.stages.chain import run_chain

logger = logging.getLogger(__name__)

OF_THE_MACHINE = (PassingFault, DiskFull, OutputFolderError, ConfigurationError)
"""Errors that say nothing about the job: it stays open, and the try does not count."""

MACHINE_ERRORS = (*NO_ROOM, errno.EROFS, errno.EACCES, errno.EPERM, errno.EIO, errno.ESTALE)
"""Numbers of such errors of the system: of its disks, or of a file server that is gone."""


@dataclass(frozen=True)
class Outcome:
    """The end of a try of a job.

    Args:
        job: which.
        record: of a settled job; None if it stays open.
        error: the reason why it stays open.
    """

    job: Job
    record: JobRecord | None = None
    error: VcageError | None = None

    @property
    def of_the_machine(self) -> bool:
        """True if the error says nothing about the job."""
        return isinstance(self.error, OF_THE_MACHINE)


def run_job(root: Path, job: Job) -> Outcome:
    """Run a job, or go on with it where it was killed; a settled one returns its record at once.

    Every error becomes an outcome. A try is counted on disk before it begins, so that a job that ends its process each
    time is given up.

    Args:
        root: the folder of the campaign.
        job: one of its plan.
    """
    folder = CampaignFolder(root)
    try:
        if (settled := folder.record(job)) is not None:
            return Outcome(job, settled)
        with folder.held(job):
            return _try(folder, job)
    except VcageError as error:
        return Outcome(job, error=error)
    except OSError as error:
        return Outcome(job, error=_of_the_system(error))


def lost_job(root: Path, job: Job, how: str) -> Outcome:
    """Note that the process of a job was lost, for drivers that saw it: the job is given up, or to be tried again.

    Args:
        root: the folder of the campaign.
        job: whose process it was.
        how: the process ended, as in "gave no sign of life for 900 s".
    """
    folder = CampaignFolder(root)
    error = PartlyDone(f"{job.id}: its process {how}", hint="it is tried again")
    try:
        with folder.held(job):
            tries = folder.tries(job)
            if not tries.open:  # lost before it could count the try
                tries = tries.model_copy(update={"count": tries.count + 1, "total": tries.total + 1})
            lost = JobError(code="lost", message=f"its process {how}")
            tries = tries.model_copy(update={"error": lost, "open": False})
            folder.note_tries(job, tries)
            if tries.count >= folder.plan.limits.tries and _reached(folder.run(job)) <= tries.reached:
                return Outcome(job, _given_up(folder, job, tries))
    except VcageError as other:
        error = other
    return Outcome(job, error=error)


def uncount_try(root: Path, job: Job) -> None:
    """Take back the try of a job whose process was ended by its driver, as by Ctrl-C or a scheduler's SIGTERM.

    Args:
        root: the folder of the campaign.
        job: whose process it was.
    """
    folder = CampaignFolder(root)
    with contextlib.suppress(VcageError, OSError), folder.held(job):
        tries = folder.tries(job)
        if tries.open:
            folder.note_tries(job, tries.model_copy(update={"count": tries.count - 1, "open": False}))


# --- one try -------------------------------------------------------------------------------------------------


def _try(folder: CampaignFolder, job: Job) -> Outcome:
    if (settled := folder.record(job)) is not None:
        return Outcome(job, settled)
    plan, run, before = folder.plan, folder.run(job), folder.tries(job)
    reached = _reached(run)
    further = reached > before.reached
    count = 0 if further else before.count
    if count >= plan.limits.tries:
        return Outcome(job, _given_up(folder, job, before))
    tries = Tries(count=count + 1, total=before.total + 1, open=True, reached=max(reached, before.reached))
    folder.note_tries(job, tries)
    measure_memory_anew()
    wall, cpu = time.perf_counter(), _cpu_seconds()
    try:
        _run(folder, plan, job)
        error = None
    except TooFewVerified:  # all episodes were run, and none verified: that is a result
        error = None
    except MissingStage as found:  # verify refused all, which is a result too
        error = None if no_episode_counts(run) else found
    except OF_THE_MACHINE:
        folder.note_tries(job, before)
        raise
    except VcageError as found:
        if found.retryable:
            return _again(folder, job, tries, found)
        error = found
    except (OSError, MemoryError) as found:
        if getattr(found, "errno", None) not in MACHINE_ERRORS:
            return _again(folder, job, tries, found)
        folder.note_tries(job, before)
        raise
    except Exception as found:
        logger.error("%s: this is a bug in vcage", job.id, exc_info=found)
        return _again(folder, job, tries, found)
    spent = {"seconds": round(time.perf_counter() - wall, 3), "cpu_seconds": round(_cpu_seconds() - cpu, 3)}
    return Outcome(job, _settle(folder, job, tries, "done" if error is None else "failed", error, spent))


def _run(folder: CampaignFolder, plan: Plan, job: Job) -> None:
    run, options, limits = folder.run(job), plan.options_of(job), plan.limits
    first = folder.run(plan.job(job.cell, 0))
    if plan.shares_crfs and job.number > 0 and first.compression.exists():
        options = replace(options, crf_of=first.root)

    def wait(seconds: float, step_s: float = 20.0) -> None:
        """Wait for a turn to ask, which is no reason to be taken for hanging."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            folder.beat(job)
            time.sleep(min(left, step_s))

    shared = Shared(folder.exchanges, Cap(limits.calls, limits.usd), limits.per_minute, wait)
    context = StageContext(replace(options.who(run), shared=shared))

    def beat(_step: str, _number: int, _total: int) -> None:
        folder.beat(job)

    @contextlib.contextmanager
    def show(_stage: str) -> Iterator[Progress]:
        folder.beat(job)
        yield beat

    run_chain(run, options, context, show)


def _again(folder: CampaignFolder, job: Job, tries: Tries, error: Exception) -> Outcome:
    """Keep the error of a try that may go better another time, or give the job up."""
    tries = tries.model_copy(update={"error": _named(error), "open": False})
    folder.note_tries(job, tries)
    if tries.count >= folder.plan.limits.tries and _reached(folder.run(job)) <= tries.reached:
        return Outcome(job, _given_up(folder, job, tries))
    kept = error if isinstance(error, VcageError) else PartlyDone(f"{job.id}: {_named(error).message}")
    return Outcome(job, error=kept)


def _given_up(folder: CampaignFolder, job: Job, tries: Tries) -> JobRecord:
    last = tries.error or JobError(code="lost", message="its process ended, or hung")
    message = f"given up after {tries.count} tries that got no further; the last: {last.message}"
    return _settle(folder, job, tries, "given_up", JobError(code=last.code, message=message), {})


def _settle(
    folder: CampaignFolder,
    job: Job,
    tries: Tries,
    state: State,
    error: Exception | JobError | None,
    spent: dict[str, Any],
) -> JobRecord:
    run = folder.run(job)
    record = JobRecord(
        cell=job.cell.id,
        number=job.number,
        seed=job.seed,
        state=state,
        episodes=job.episodes,
        tries=max(tries.total, 1),
        error=error if error is None or isinstance(error, JobError) else _named(error),
        host=platform.node(),
        ended=datetime.now(UTC).isoformat(timespec="seconds"),
        bytes=_bytes(run.root),
        memory_bytes=largest_memory(),
        **_episodes(run, job),
        **spent,
    )
    record.write(folder.record_file(job))
    folder.tries_file(job).unlink(missing_ok=True)
    return record


def _episodes(run: RunFolder, job: Job) -> dict[str, Any]:
    """Counts of the episodes of a run; only what was asked where none were run."""
    if not run.episodes.exists():
        return {"asked": job.episodes}
    found, refused = Episodes.read(run.episodes), dict[str, str]()
    with contextlib.suppress(NotJudged):  # given up before verify
        refused = refusals(run)
    wanted = Wanted.of(job.episodes, Subtasks.read(run.subtasks))
    kept = [episode for episode in found.episodes if episode.accepted and episode.file not in refused]
    reasons = Counter(e.reason for e in found.episodes if not e.accepted)
    reasons.update(refused[str(e.file)] for e in found.episodes if e.accepted and e.file in refused)
    return {
        "asked": wanted.total,
        "verified": len(kept),
        "tried": len(found.episodes),
        "attempts": found.attempts,
        "rejected": dict(sorted(reasons.items())),
        "critic": found.critic,
        "spread": found.spread(),
    }


def _reached(run: RunFolder) -> tuple[int, int]:
    """Progress of a job: finished stages, and files; a try that raises neither got no further."""
    names = (name for _, _, names in os.walk(run.root) for name in names)
    files = sum(PARTIAL not in name and name.partition(".")[0] not in ("in-use", "unfinished") for name in names)
    return sum(path.exists() for path in run.documents), files


def _bytes(folder: Path) -> int:
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file() and not path.is_symlink())


def _cpu_seconds() -> float:
    own, others = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return own.ru_utime + own.ru_stime + others.ru_utime + others.ru_stime


def _named(error: Exception) -> JobError:
    if isinstance(error, VcageError):
        return JobError(code=error.code, message=error.as_line()[:2000])
    return JobError(code="bug", message=" ".join(f"{type(error).__name__}: {error}".split())[:2000])


def _of_the_system(error: OSError) -> VcageError:
    if error.errno in NO_ROOM:
        return DiskFull(f"no space left: {error}", hint="free some space and run the same command again")
    return OutputFolderError(f"cannot write: {error}", hint="make the folder of the campaign writable")
