"""State of a cell: jobs that may begin, jobs that wait for others, and why no more follow.

It depends on the plan and on the records of earlier jobs of the cell, never on the order in which jobs end. So the same
jobs are run by any driver, however often it was killed.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from vcage.campaigns.plan import Cell, Job, Plan
from vcage.campaigns.record import JobRecord
from vcage.episodes.quota import RUNS_PER_EPISODE


@dataclass(frozen=True)
class Standing:
    """A cell at one moment.

    Args:
        cell: which.
        asked: number of verified episodes that are wanted.
        verified: number of verified episodes so far.
        tried: episodes that were run; of a job that failed at least those that it should have collected.
        ready: jobs that may begin, if nobody runs them yet.
        waits: True if more jobs may follow once others are settled.
        closed: the reason why it ends with fewer episodes than asked; empty if it does not.
    """

    cell: Cell
    asked: int
    verified: int
    tried: int
    ready: Sequence[Job] = field(default=())
    waits: bool = False
    closed: str = ""

    @property
    def ended(self) -> bool:
        return not self.ready and not self.waits


def standing(plan: Plan, cell: Cell, records: Mapping[int, JobRecord]) -> Standing:
    """Return the state of a cell.

    Args:
        plan: of the campaign.
        cell: one of its cells.
        records: number → record of its settled jobs.
    """
    jobs = list(plan.jobs_of(cell))
    planned = len(jobs)
    while True:
        ready, waits, closed = _open_jobs(plan, cell, jobs, records)
        if ready or waits or closed or cell.task.all_subtasks:
            break
        missing = plan.episodes - sum(records[job.number].verified for job in jobs)
        if missing <= 0:
            break
        if all(records[job.number].state != "done" for job in jobs):
            closed = f"all of its {len(jobs)} jobs failed"
            break
        # Another round, which depends on those before alone.
        each, count = plan.episodes_per_job, math.ceil(missing / plan.episodes_per_job)
        jobs += [plan.job(cell, len(jobs) + n, min(each, missing - n * each)) for n in range(count)]
    verified = sum(record.verified for record in records.values())
    return Standing(cell, _asked(plan, cell, jobs[:planned], records), verified, _tried(records), ready, waits, closed)


def by_cell(plan: Plan, records: Iterable[JobRecord]) -> dict[str, dict[int, JobRecord]]:
    """Records of the plan's cells, by cell and number, without jobs of which the plan now asks for more episodes."""
    found: dict[str, dict[int, JobRecord]] = {cell.id: {} for cell in plan.cells}
    for record in records:
        grown = record.state == "done" and record.episodes < plan.asked_of(record.number)
        if record.cell in found and not grown:
            found[record.cell][record.number] = record
    return found


def _open_jobs(
    plan: Plan, cell: Cell, jobs: Sequence[Job], records: Mapping[int, JobRecord]
) -> tuple[list[Job], bool, str]:
    """Jobs that may begin, in order; True if others wait for them; the reason why no more may begin.

    A job may begin only if no result of a running job could forbid it.
    """
    ready: list[Job] = []
    most, most_tried = _most(plan, cell), 0.0  # if all unsettled jobs before run as many episodes as they may
    for job in jobs:
        settled = records.get(job.number)
        if settled is None and (held := _held_back(plan, job, ready, records)) is not None:
            return ready, *held
        if most_tried >= most:
            return (ready, True, "") if ready else ([], False, f"{most_tried:.0f} episodes were run, the most allowed")
        if settled is None:
            ready.append(job)
        most_tried += _most_of(job) if settled is None else _tried({job.number: settled})
    return ready, False, ""


def _most(plan: Plan, cell: Cell) -> float:
    """Episodes that may be run in a cell; of each sub-task, of which there may be any number, without a limit."""
    return plan.limits.attempts or (math.inf if cell.task.all_subtasks else RUNS_PER_EPISODE * plan.episodes)


def _most_of(job: Job) -> float:
    """Episodes that a job may run."""
    return math.inf if job.cell.task.all_subtasks else RUNS_PER_EPISODE * job.episodes


def _held_back(plan: Plan, job: Job, ready: Sequence[Job], records: Mapping[int, JobRecord]) -> tuple[bool, str] | None:
    """(True, "") if a job waits for those before it, (False, reason) if it never begins; None if it may begin."""
    if ready and ready[0].number < plan.deciding(job.number):
        return True, ""
    if job.number >= plan.probes and (reason := _gate(plan, records)):
        return False, reason
    return None


def _gate(plan: Plan, records: Mapping[int, JobRecord]) -> str:
    """The reason to stop a cell after its first jobs; empty to go on."""
    if plan.gates is None:
        return ""
    first = {number: record for number, record in records.items() if number < plan.probes}
    verified, tried = sum(record.verified for record in first.values()), _tried(first)
    if tried == 0 or verified / tried >= plan.gates.acceptance:
        return ""
    return f"{verified} of the first {tried} episodes accepted, below the gate of {plan.gates.acceptance:g}"


def _tried(records: Mapping[int, JobRecord]) -> int:
    """Episodes that were run; of a job that failed at least as many as it should have collected."""
    return sum(max(record.tried, record.episodes) for record in records.values())


def _asked(plan: Plan, cell: Cell, planned: Sequence[Job], records: Mapping[int, JobRecord]) -> int:
    """Wanted episodes; how many sub-tasks a scene has is known of settled jobs."""
    if not cell.task.all_subtasks:
        return plan.episodes
    return sum(records[job.number].asked if job.number in records else job.episodes for job in planned)
