"""The loop that all drivers share, and the driver that runs jobs in processes of this machine.

All progress lies in the folder of the campaign, so any driver may be killed, and any other go on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path
from typing import Protocol

from vcage.base.memory import free_memory
from vcage.base.progress import Progress, silent
from vcage.base.workers import Processes, cores, preload_module
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.hanging import HangWatch
from vcage.campaigns.job import Outcome, lost_job, run_job, uncount_try
from vcage.campaigns.plan import Job
from vcage.campaigns.schedule import Schedule
from vcage.campaigns.shard import EVERY_JOB, Shard


class Crew(AbstractContextManager, Protocol):
    """The processes, of this machine or others, that run the jobs of a driver."""

    def submit(self, task: Job, /) -> None:
        """Add a job; it begins as soon as there is room."""
        ...

    def results(self) -> Iterator[Outcome]:
        """Yield outcomes as they arrive, until none is awaited; more jobs may be submitted meanwhile."""
        ...


def work_through(schedule: Schedule, crew: Crew, width: int | Callable[[], int], progress: Progress = silent) -> None:
    """Give jobs to a crew until none is left that may begin.

    Args:
        schedule: of the driver.
        crew: runs them.
        width: number of jobs at a time, or a function that returns it.
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
    shard: Shard = EVERY_JOB,
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
        The schedule, with the jobs that are left.

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
        memory_bytes: free memory for each process; measured, one takes 1.1 GB at most (``unit_costs.yml``).
    """
    return max(1, min(cores(), free_memory() // memory_bytes))
