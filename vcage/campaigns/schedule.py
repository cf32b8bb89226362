"""The jobs that are left to a driver, in their order, as far as others let them begin."""

from __future__ import annotations

import heapq
import logging
import time
from collections import Counter
from dataclasses import dataclass

from vcage.base.errors import FolderInUse, PartlyDone, SpendingCap, VcageError
from vcage.base.text import listed
from vcage.campaigns.cells import Standing, by_cell, standing
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.job import Outcome
from vcage.campaigns.job_errors import LACKING
from vcage.campaigns.plan import Cell, Job
from vcage.campaigns.record import JobRecord
from vcage.campaigns.shard import EVERY_JOB, Shard

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class LoopSettings:
    """Settings of the loop.

    Args:
        machine_tries: of a job that the machine cannot run for now, or that another process holds.
        machine_faults: in a row, of any jobs, after which the loop ends: the disk is full, or the folder gone.
        pause_s: before such jobs are tried again, and before another look at jobs of others that decide on ours.
    """

    machine_tries: int = 3
    machine_faults: int = 20
    pause_s: float = 2.0


SETTINGS = LoopSettings()


class Schedule:
    """The jobs that are left to a driver, in the order of the plan, as far as gates, limits and the first jobs of their
    cells let them begin.

    Jobs of other shares that decide on own ones come last: they are run here where nobody else runs them, and else
    waited for.

    Args:
        folder: of the campaign, with its plan.
        shard: the driver's share.
        settings: of the loop.
    """

    def __init__(self, folder: CampaignFolder, shard: Shard = EVERY_JOB, settings: LoopSettings = SETTINGS):
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
        self._to_come: dict[str, int] = {}
        self._ready: list[tuple[bool, int, str]] = []
        self._jobs: dict[str, Job] = {}
        self._awaited: dict[str, int] = {}
        self._put_off: list[Job] = []
        self._last: dict[str, int] = {}
        self._deciding: set[str] = set()
        self._elsewhere: list[Job] = []
        self._faults: Counter[str] = Counter()
        self._faults_in_a_row = 0
        for cell in self.plan.cells:
            self._look_at(cell)

    # --- for the loop ---------------------------------------------------------------------------------------

    def next(self) -> Job | None:
        """The next job to begin; None if none may begin now."""
        while self.stopped is None and self._ready:
            job = self._jobs.pop(heapq.heappop(self._ready)[-1])
            if job.id not in self._deciding or self._is_left(job):
                return job
        return None

    def ended(self, outcome: Outcome) -> None:
        """Take the outcome of a job that was begun."""
        job, error = outcome.job, outcome.error
        self._look_elsewhere()
        if outcome.record is not None:
            self._faults_in_a_row = 0
            self.open.pop(job.id, None)
            self._keep(job, outcome.record)
        elif isinstance(error, (*LACKING, SpendingCap)):
            self.open[job.id] = self.stopped = error  # for any job
        elif isinstance(error, FolderInUse) and job.id in self._deciding and self.folder.is_held(job):
            self._elsewhere.append(job)
        elif outcome.of_the_machine and error is not None:
            self._put_off_for(job, error)
        elif error is not None:  # its tries are counted on disk, and end with a record
            logger.warning("%s: %s; it is tried again", job.id, error.message)
            self._push(job)

    def look_again(self) -> bool:
        """Look for jobs that may begin after all, when none runs any more; False if there are none."""
        if self.stopped is not None:
            return False
        if self._put_off or self._elsewhere:
            time.sleep(self._settings.pause_s)
            while self._put_off:
                self._push(self._put_off.pop())
            self._look_elsewhere()
        if not self._ready:
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
        """Jobs that were settled before, and those of this driver's share that may begin, now or later by the plan."""
        return self._settled_before + len(self._known) + sum(self._to_come.values())

    # --- inside ---------------------------------------------------------------------------------------------

    def _push(self, job: Job) -> None:
        self._jobs[job.id] = job
        heapq.heappush(self._ready, (not self._is_ours(job), self.plan.index_of(job), job.id))

    def _is_ours(self, job: Job) -> bool:
        return self._shard.has(self.plan.index_of(job))

    def _decides_on_ours(self, job: Job, found: Standing) -> bool:
        """True if jobs of this driver's share wait for it, whosever it is."""
        return found.waits and job.number < self.plan.deciding(self._last_of_ours(job.cell))

    def _last_of_ours(self, cell: Cell) -> int:
        """The number of the last planned job of a cell in this driver's share; 0 if there is none, as nothing decides
        on the first.
        """
        if cell.id not in self._last:
            own = (job.number for job in reversed(self.plan.jobs_of(cell)) if self._is_ours(job))
            self._last[cell.id] = next(own, 0)
        return self._last[cell.id]

    def _is_left(self, job: Job) -> bool:
        """True if nobody has settled a job or runs it; else keep its record, or look again later."""
        if job.number in self._records[job.cell.id]:
            return False
        if (record := self.folder.record(job)) is not None:
            self._keep(job, record)
            return False
        if held := self.folder.is_held(job):
            self._elsewhere.append(job)
        return not held

    def _look_elsewhere(self) -> None:
        """Have another look at the jobs that others ran."""
        while self._elsewhere:
            self._push(self._elsewhere.pop())

    def _keep(self, job: Job, record: JobRecord) -> None:
        """Take a record, and look at its cell again if that may let other jobs begin."""
        self.settled += job.number not in self._records[job.cell.id]
        self._records[job.cell.id][job.number] = record
        self._awaited[job.cell.id] -= 1
        if self._awaited[job.cell.id] <= 0:
            self._look_at(job.cell)

    def _look_at(self, cell: Cell) -> None:
        """Let those jobs of a cell begin that may, and have not begun here yet."""
        found = self.standing(cell)
        # Jobs to be settled before another look is of use: all, or any where others wait for them.
        self._awaited[cell.id] = 1 if found.waits else len(found.ready)
        for job in found.ready:
            decides = self._decides_on_ours(job, found)
            if decides:
                self._deciding.add(job.id)
            if (decides or self._is_ours(job)) and job.id not in self._known:
                self._known.add(job.id)
                self._push(job)
        left = (job for job in self.plan.jobs_of(cell) if job.number not in self._records[cell.id])
        self._to_come[cell.id] = sum(self._is_ours(job) and job.id not in self._known for job in left)
        if found.closed:
            self._to_come[cell.id] = 0

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
