"""Progress of a campaign, from the records of its jobs alone: per cell, in all, and the cost of models.

Records appear whole, so they are read while other processes write them.
"""

from __future__ import annotations

import contextlib
import time
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

from vcage.apps.html import rendered
from vcage.base.errors import InputFileError
from vcage.base.files import write_text
from vcage.base.hold import holder_of, one_at_a_time
from vcage.campaigns.cells import by_cell, standing
from vcage.campaigns.figures import CellStatus, OpenJob, RunningJob, Status
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.plan import Cell, Plan
from vcage.campaigns.record import JobRecord, read_tries
from vcage.models.bill import Bill

TEMPLATE = Path(__file__).with_name("status.html.jinja")


def status_of(folder: CampaignFolder, plan: Plan | None = None, without: Collection[str] = ()) -> Status:
    """Look at a campaign; nothing is written.

    Args:
        folder: of the campaign.
        plan: to go on with; None for the one in the folder.
        without: ids of jobs that count as not run.

    Example:
        >>> status_of(CampaignFolder("campaigns/desk")).total.verified

    Raises:
        MissingStage: the folder holds no campaign.
        InputFileError: its plan cannot be read, or a folder of jobs cannot be listed.
    """
    plan = plan or folder.plan
    unread: list[InputFileError] = []
    records = by_cell(plan, (record for record in folder.records(unread.append) if record.job_id not in without))
    running, open_jobs = _begun(folder)
    of_cell = Counter(one.job.rpartition("/")[0] for one in running)
    cells = [_cell_status(plan, cell, records[cell.id], of_cell[cell.id]) for cell in plan.cells]
    lines = [error.as_line() for error in unread]
    settled = {record.job_id for found in records.values() for record in found.values()}
    open_jobs = [one for one in open_jobs if one.job not in settled]  # a process that was killed left its tries
    return Status(plan, cells, running, Bill(folder.bill).refresh(), lines, open_jobs)


def write_page(folder: CampaignFolder, status: Status, refresh_s: int = 0) -> Path:
    """Write ``status.html``, the report of the campaign as far as it is.

    Args:
        folder: of the campaign.
        status: what it shows.
        refresh_s: seconds after which a browser loads it again; 0 for never.
    """
    values = {"status": status, "refresh": refresh_s, "now": time.strftime("%Y-%m-%d %H:%M:%S"), "root": str(folder)}
    with one_at_a_time(folder.page):  # drivers on several machines end at about the same time
        return write_text(folder.page, rendered(TEMPLATE, values))


def table(status: Status, most: int = 60) -> str:
    """The status in words and columns, for a terminal.

    Args:
        status: of the campaign.
        most: cells that are listed, those that go on first.
    """
    total = status.total
    lines = [
        f"{status.plan.name}: {total.verified} of {total.asked} episodes verified, {status.left} left, "
        f"{len(status.running)} jobs running, {total.jobs['done']} done, {len(status.not_done)} not done"
    ]
    if total.per_worker_hour:
        left = f", about {status.time_left} left" if status.time_left else ""
        lines.append(f"{total.per_worker_hour:.1f} verified episodes an hour and process{left}")
    if status.spent:
        lines.append(f"models: {status.calls} answers, {status.usd:.4f} USD")
    lines += ["", *_columns(status.cells, most)]
    for record in status.not_done[:10]:
        assert record.error is not None
        lines.append(f"{record.state.replace('_', ' ')}: {record.job_id}: {record.error.message}")
    lines += [f"to be tried again: {one.job}: {one.error.message}" for one in status.open[:10]]
    if status.unread:
        lines.append(f"records that cannot be read, and count as missing: {len(status.unread)}")
        lines += status.unread[:10]
    return "\n".join(lines)


# --- inside ------------------------------------------------------------------------------------------------


def _columns(cells: Sequence[CellStatus], most: int) -> Iterator[str]:
    """Lines with the figures of the first cells, those that go on before the others."""
    rows = [["cell", "asked", "running", "verified", "rejected", "left", "state"]]
    for cell in sorted(cells, key=lambda cell: cell.left == 0)[:most]:
        figures = (cell.asked, cell.running, cell.verified, cell.tried - cell.verified, cell.left)
        rows.append([cell.name, *map(str, figures), cell.state])
    widths = [max(len(row[column]) for row in rows) for column in range(6)]
    for name, *figures, state in rows:
        columns = "  ".join(figure.rjust(width) for figure, width in zip(figures, widths[1:]))
        yield f"{name.ljust(widths[0])}  {columns}  {state}"
    if len(cells) > most:
        yield f"… and {len(cells) - most} more cells"


def _cell_status(plan: Plan, cell: Cell, records: dict[int, JobRecord], running: int) -> CellStatus:
    found = standing(plan, cell, records)
    return CellStatus(cell.id, found.asked, [records[n] for n in sorted(records)], running, found)


def _begun(folder: CampaignFolder) -> tuple[list[RunningJob], list[OpenJob]]:
    """Jobs whose lock another process holds, and those whose last try ended with an error."""
    running, open_jobs = [], []
    for path in folder.begun():
        job = f"{path.parent.name}/{path.name.partition('.')[0]}"
        with contextlib.suppress(OSError):
            if (holder := holder_of(path)) is not None:
                silent_s = max(0.0, time.time() - path.stat().st_mtime)
                running.append(RunningJob(job, holder, silent_s))
            elif (error := read_tries(path.with_suffix(".tries.json")).error) is not None:
                open_jobs.append(OpenJob(job, error))
    return running, open_jobs
