"""The loop that all drivers share, and the driver that runs jobs in processes of this machine.

What is done lies in the folder of the campaign alone, so any driver may be killed, and any other go on.
"""

from __future__ import annotations

import heapq
import logging
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol

from vcage.base.errors import ConfigurationError, FolderInUse, PartlyDone, VcageError
from vcage.base.memory import free_memory
from vcage.base.progress import Progress, silent
from vcage.base.text import listed
from vcage.base.workers import Processes, cores, preload_module
from vcage.campaigns.cells import Standing, by_cell, standing
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.hanging import HangWatch
from vcage.campaigns.job import Outcome, lost_job, run_job, uncount_try
from vcage.campaigns.plan import Cell, Job
from vcage.campaigns.record import JobRecord

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Shard:
    """A share of the jobs: those whose place in the plan leaves ``index`` when divided by ``count``."""

    index: int = 0
    count: int = 1


@dataclass(frozen=True)
class LoopSettings:
    """Settings of the loop.

    Args:
        machine_tries: of a job that the machine cannot run for now, or that another process holds.
        machine_faults: in a row, of any jobs, after which the loop ends: the disk is full, or the folder gone.
        pause_s: before such jobs are tried again.
    """

    machine_tries: int = 3
    machine_faults: int = 20
    pause_s: float = 2.0


SETTINGS = LoopSettings()


class Crew(AbstractContextManager, Protocol):
    """The processes, of this machine or others, that run the jobs of a driver."""

    def submit(self, task: Job, /) -> None:
        """Add a job; it begins as soon as there is room."""
        ...

    def results(self) -> Iterator[Outcome]:
        """Yield outcomes as they arrive, until none is awaited; more jobs may be submitted meanwhile."""
        ...


class Schedule:
    """The jobs that are left to a driver, in the order of the plan, as far as gates and limits let them begin.

    Args:
        folder: of the campaign, with its plan.
        shard: the driver's share.
        settings: of the loop.
    """

    def __init__(self, folder: CampaignFolder, shard: Shard = Shard(), settings: LoopSettings = SETTINGS):
        self.folder, self.plan, self._shard, self._settings = folder, folder.plan, shard, settings
        self.open: dict[str, VcageError] = {}
        """Job → why it stays open after this driver."""
        self.stopped: VcageError | None = None
        """The error for which no more jobs begin."""
        self._records = by_cell(self.plan, folder.records())
        self.settled = sum(map(len, self._records.values()))
        """Jobs that are settled."""
        self._settled_before = self.settled
        self._known: set[str] = set()
        self._ready: list[tuple[int, str]] = []
        self._jobs: dict[str, Job] = {}
        self._awaited: dict[str, int] = {}
        self._put_off: list[Job] = []
        self._faults: Counter[str] = Counter()
        self._faults_in_a_row = 0
        for cell in self.plan.cells:
            self._look_at(cell)

    # --- for the loop ---------------------------------------------------------------------------------------

    def next(self) -> Job | None:
        """The next job to begin; None if none may begin now."""
        if self.stopped is not None or not self._ready:
            return None
        return self._jobs.pop(heapq.heappop(self._ready)[1])

    def ended(self, outcome: Outcome) -> None:
        """Take the outcome of a job that was begun."""
        job, error = outcome.job, outcome.error
        if outcome.record is not None:
            self._faults_in_a_row = 0
            self.open.pop(job.id, None)
            self._keep(job, outcome.record)
        elif isinstance(error, ConfigurationError) and type(error) is not ConfigurationError:
            self.open[job.id] = self.stopped = error  # a key, a package or money is missing, for any job
        elif outcome.of_the_machine and error is not None:
            self._put_off_for(job, error)
        elif error is not None:  # its tries are counted on disk, and end with a record
            logger.warning("%s: %s; it is tried again", job.id, error.message)
            self._push(job)

    def look_again(self) -> bool:
        """Look for jobs that may begin after all, when none runs any more; False if there are none."""
        if self.stopped is not None:
            return False
        if self._put_off:
            time.sleep(self._settings.pause_s)
            while self._put_off:
                self._push(self._put_off.pop())
        for cell in self.plan.cells:
            if not self.standing(cell).ended:
                self._reread(cell)
        return bool(self._ready)

    # --- for reports ----------------------------------------------------------------------------------------

    def standing(self, cell: Cell) -> Standing:
        """State of a cell, by the records that are known here."""
        return standing(self.plan, cell, self._records[cell.id])

    @property
    def known(self) -> int:
        """Jobs of this driver's share that may begin so far, and those settled before."""
        return self._settled_before + len(self._known)

    # --- inside ---------------------------------------------------------------------------------------------

    def _push(self, job: Job) -> None:
        self._jobs[job.id] = job
        heapq.heappush(self._ready, (self.plan.index_of(job), job.id))

    def _keep(self, job: Job, record: JobRecord) -> None:
        """Take a record, and look at its cell again if that may let other jobs begin."""
        self._records[job.cell.id][job.number] = record
        self.settled += 1
        self._awaited[job.cell.id] -= 1
        if self._awaited[job.cell.id] <= 0:
            self._look_at(job.cell)

    def _look_at(self, cell: Cell) -> None:
        """Let those jobs of a cell begin that may, and have not begun here yet."""
        found = self.standing(cell)
        # Jobs to be settled before another look is of use: all, or any where others wait for them.
        self._awaited[cell.id] = 1 if found.waits else len(found.ready)
        for job in found.ready:
            ours = self.plan.index_of(job) % self._shard.count == self._shard.index
            if ours and job.id not in self._known:
                self._known.add(job.id)
                self._push(job)

    def _reread(self, cell: Cell) -> None:
        """Read the records of jobs that others may have settled meanwhile."""
        for job in self.standing(cell).ready:
            if (record := self.folder.record(job)) is not None:
                self.open.pop(job.id, None)
                self._keep(job, record)

    def _put_off_for(self, job: Job, error: VcageError) -> None:
        self.open[job.id] = error
        self._faults[job.id] += 1
        if not isinstance(error, FolderInUse):
            logger.warning("%s: %s", job.id, error.message)
            self._faults_in_a_row += 1
        if self._faults_in_a_row >= self._settings.machine_faults:
            self.stopped = error
        elif self._faults[job.id] < self._settings.machine_tries:
            self._put_off.append(job)


def work_through(schedule: Schedule, crew: Crew, width: int | Callable[[], int], progress: Progress = silent) -> None:
    """Give jobs to a crew until none is left that may begin.

    Args:
        schedule: of the driver.
        crew: runs them.
        width: jobs that it is given at a time, or what tells their number now.
        progress: called before each job.
    """
    running: dict[str, Job] = {}

    def fill() -> None:
        while len(running) < (width() if callable(width) else width) and (job := schedule.next()) is not None:
            progress(job.id, schedule.settled, schedule.known)
            running[job.id] = job
            crew.submit(job)

    try:
        with crew:
            while True:
                fill()
                if not running and not schedule.look_again():
                    return
                for outcome in crew.results():
                    del running[outcome.job.id]
                    schedule.ended(outcome)
                    fill()
    except BaseException:  # the crew has ended the jobs that ran
        for job in running.values():
            uncount_try(schedule.folder.root, job)
        raise


def run_here(
    folder: CampaignFolder,
    workers: int | None = None,
    shard: Shard = Shard(),
    progress: Progress = silent,
    work: Callable[[Path, Job], Outcome] = run_job,
) -> Schedule:
    """Run the jobs of a campaign in processes of this machine.

    Args:
        folder: of the campaign, with its plan.
        workers: processes; by default as many as cores and memory allow.
        shard: the share of the jobs.
        progress: called before each job.
        work: runs a job in a process.

    Returns:
        The schedule, with what is left.

    Raises:
        InputFileError: the plan, or a record, cannot be read.
    """
    schedule = Schedule(folder, shard)
    count = workers or workers_here()
    preload_module("vcage.episodes.preload", "vcage.campaigns.job")
    watch, root = HangWatch(folder.root), folder.root
    crew: Processes[Job, Outcome] = Processes(
        partial(work, root), count, watch.seconds_left, lost=lambda job, how: lost_job(root, job, how)
    )
    work_through(schedule, crew, count, progress)
    return schedule


def workers_here(memory_bytes: int = 1_200_000_000) -> int:
    """Processes that this machine has cores and memory for.

    Args:
        memory_bytes: free memory for each process; measured, one takes 0.94 GB at most.
    """
    return max(1, min(cores(), free_memory() // memory_bytes))


def left_over(schedule: Schedule) -> VcageError | None:
    """The error that a driver ends with where jobs are left; None if none are."""
    if schedule.stopped is not None:
        return schedule.stopped
    waiting = [s.cell.id for s in map(schedule.standing, schedule.plan.cells) if not s.ended]
    if not waiting:
        return None
    reasons = "; ".join(f"{name}: {error.message}" for name, error in list(schedule.open.items())[:3])
    why = reasons or "their jobs are those of other shards, or wait for these"
    return PartlyDone(
        f"{len(waiting)} of {len(schedule.plan.cells)} cells are not finished ({listed(waiting, 3)}): {why}",
        hint=next(
            (error.hint for error in schedule.open.values()), "run the same command again when the others have ended"
        ),
        details={"cells": waiting[:100], "open": {name: error.code for name, error in schedule.open.items()}},
    )
