"""One job: a run folder through the whole chain in this process, counted, timed, and settled once."""

from __future__ import annotations

import contextlib
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

from vcage.base.errors import NotJudged, PartlyDone, VcageError
from vcage.base.files import RunFolder
from vcage.base.folders import size_of
from vcage.base.leftovers import PARTIAL
from vcage.base.memory import largest_memory, measure_memory_anew
from vcage.base.progress import Progress
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.job_errors import OF_THE_MACHINE, Meaning, meaning_of, named, of_the_machine, of_the_system
from vcage.campaigns.plan import Job, Plan
from vcage.campaigns.record import JobError, JobRecord, State, Tries
from vcage.episodes.quota import Wanted
from vcage.models.shared import Shared
from vcage.models.spending import Cap
from vcage.runs.accepted import refusals
from vcage.runs.context import StageContext
from vcage.schema.episodes import Episodes
from vcage.schema.subtasks import Subtasks
from vcage.stages.chain import run_chain


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
        return Outcome(job, error=of_the_system(error))


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
            if (settled := folder.record(job)) is not None:  # lost after it had ended
                return Outcome(job, settled)
            tries = folder.tries(job)
            if not tries.open:  # lost before it could count the try
                tries = tries.model_copy(update={"count": tries.count + 1, "total": tries.total + 1})
            lost = JobError(code="lost", message=f"its process {how}")
            tries = tries.model_copy(update={"error": lost, "open": False})
            folder.note_tries(job, tries)
            if _is_last(folder, job, tries):
                return Outcome(job, _given_up(folder, job, tries))
    except VcageError as other:
        return Outcome(job, error=other)
    except OSError as other:
        return Outcome(job, error=of_the_system(other))
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
    before = folder.tries(job)
    tries = _next_try(folder, job, before)
    if tries.count > folder.plan.limits.tries:
        return Outcome(job, _given_up(folder, job, before))
    folder.note_tries(job, tries)
    measure_memory_anew()
    wall, cpu = time.perf_counter(), _cpu_seconds()
    error, meaning = _error_of_run(folder, job)
    if error is not None and meaning is Meaning.MACHINE:
        fault = of_the_machine(error)
        folder.note_fault(job, before, named(fault))
        raise fault
    if error is not None and meaning is Meaning.AGAIN:
        return _again(folder, job, tries, error)
    spent = {"seconds": round(time.perf_counter() - wall, 3), "cpu_seconds": round(_cpu_seconds() - cpu, 3)}
    if meaning is Meaning.RESULT:
        return Outcome(job, _settle(folder, job, tries, "done", None, spent))
    return Outcome(job, _settle(folder, job, tries, "failed", error, spent))


def _next_try(folder: CampaignFolder, job: Job, before: Tries) -> Tries:
    """The try that would begin now; it is the first again where the last one got further."""
    reached = _reached(folder.run(job))
    count = 0 if reached > before.reached else before.count
    return Tries(count=count + 1, total=before.total + 1, open=True, reached=max(reached, before.reached))


def _error_of_run(folder: CampaignFolder, job: Job) -> tuple[Exception | None, Meaning]:
    """Run the chain; its error, if one ended it, and what that means."""
    try:
        _run(folder, folder.plan, job)
    except Exception as error:
        return error, meaning_of(error, folder.run(job))
    return None, Meaning.RESULT


def _run(folder: CampaignFolder, plan: Plan, job: Job) -> None:
    run, options, limits = folder.run(job), plan.options_of(job), plan.limits
    first = folder.run(plan.job(job.cell, 0))
    if plan.shares_crfs and job.number > 0 and first.compression.exists():
        options = replace(options, crf_of=first.root)

    def wait(seconds: float, step_s: float = 20.0) -> None:
        """Wait for a turn to ask; beats, lest the job seems to hang."""
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
    """Note the error of a try that may go better another time, or give the job up."""
    tries = tries.model_copy(update={"error": named(error), "open": False})
    folder.note_tries(job, tries)
    if _is_last(folder, job, tries):
        return Outcome(job, _given_up(folder, job, tries))
    reason = error if isinstance(error, VcageError) else PartlyDone(f"{job.id}: {named(error).message}")
    return Outcome(job, error=reason)


def _is_last(folder: CampaignFolder, job: Job, tries: Tries) -> bool:
    """True if the plan allows no further try after one that got no further."""
    return tries.count >= folder.plan.limits.tries and _reached(folder.run(job)) <= tries.reached


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
    folder.beat(job)
    run = folder.run(job)
    size, files = size_of(run.root)
    record = JobRecord(
        cell=job.cell.id,
        number=job.number,
        seed=job.seed,
        state=state,
        episodes=job.episodes,
        tries=max(tries.total, 1),
        error=error if error is None or isinstance(error, JobError) else named(error),
        host=platform.node(),
        ended=datetime.now(UTC).isoformat(timespec="seconds"),
        bytes=size,
        files=files,
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
    verified = [episode for episode in found.episodes if episode.accepted and episode.file not in refused]
    reasons = Counter(e.reason for e in found.episodes if not e.accepted)
    reasons.update(refused[str(e.file)] for e in found.episodes if e.accepted and e.file in refused)
    return {
        "asked": wanted.total,
        "verified": len(verified),
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


def _cpu_seconds() -> float:
    own, others = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return own.ru_utime + own.ru_stime + others.ru_utime + others.ru_stime
