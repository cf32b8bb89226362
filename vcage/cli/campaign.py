"""``vcage campaign`` and ``vcage status``: many runs by one plan, and their progress."""

from __future__ import annotations

import logging
import shlex
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from tyro.conf import Positional, arg

from vcage.base.commands import vcage_command
from vcage.base.errors import DiskFull, OutputFolderError, TooFewVerified, UsageError
from vcage.base.files import write_text
from vcage.base.options import FILE, FOLDER, POSITIVE, UNSAID, Flag, between, value
from vcage.cli.arguments import Command
from vcage.cli.going_on import not_dry
from vcage.cli.output import Result
from vcage.cli.progress import progress
from vcage.cli.streams import print_text

if TYPE_CHECKING:
    from vcage.base.progress import Progress
    from vcage.campaigns.figures import Status
    from vcage.campaigns.folder import CampaignFolder
    from vcage.campaigns.plan import Plan
    from vcage.campaigns.schedule import Schedule
    from vcage.campaigns.shard import Shard

logger = logging.getLogger(__name__)


def _shard(text: str) -> tuple[int, int]:
    """``i/n`` as (i, n)."""
    index, _, count = text.partition("/")
    if not (index.isdecimal() and count.isdecimal() and int(index) < int(count)):
        raise ValueError(f"{text!r} is no share; expected i/n with i from 0 to n - 1, as in 0/4")
    return int(index), int(count)


SHARD = value(_shard, "I/N", show=lambda shard: "/".join(map(str, shard or ())))


def _address(text: str) -> str:
    """The address of a Ray cluster."""
    from vcage.campaigns.ray_cluster import address_of

    return address_of(text)


RAY = value(_address, "auto|HOST:PORT", show=str)


@dataclass(frozen=True, kw_only=True)
class Campaign(Command):
    """Make a data set of many runs by one plan: instructions, robots, layouts, looks and seeds, with counts and limits.

    A job is one run folder of a few episodes. All progress lies in DIR, so an interrupted campaign goes on when it is
    started again. Its drivers are processes of this machine, shards that a scheduler runs, or a Ray cluster; several
    may work on one DIR at a time. docs/campaigns.md explains the plan.

    examples:
      vcage campaign PLAN.yml --out campaigns/desk
      vcage campaign PLAN.yml --out campaigns/desk --workers 8
      vcage campaign PLAN.yml --out campaigns/desk --shard 3/16
      vcage campaign PLAN.yml --out campaigns/desk --slurm 16 --workers 4
      vcage campaign PLAN.yml --out campaigns/desk --ray auto
    """

    plan: Annotated[Path, FILE, Positional, arg(metavar="PLAN")]
    """the plan, a YAML file"""
    out: Annotated[Path, FOLDER]
    """the folder of the campaign"""
    workers: Annotated[int | None, POSITIVE, UNSAID] = None
    """processes (default: as many as cores and memory allow; with --slurm and --k8s 1 for each task; with --ray as many
    as the cluster has processors)"""
    shard: Annotated[tuple[int, int] | None, SHARD, UNSAID] = None
    """run only every N-th job, from the I-th on: for N schedulers' tasks, numbered from 0, on one shared folder"""
    ray: Annotated[str | None, RAY, UNSAID] = None
    """run jobs on the Ray cluster whose head is at HOST:PORT; "auto": on that of this machine, or one started for it"""
    slurm: Annotated[int | None, POSITIVE, UNSAID] = None
    """run nothing, and write a script of SLURM for an array of so many tasks"""
    k8s: Annotated[int | None, POSITIVE, UNSAID] = None
    """run nothing, and write a Job of Kubernetes with so many indices"""
    retry: Flag = False
    """first try jobs again that failed or were given up; with --shard those of the share"""
    dry_run: Flag = False
    """check the plan and estimate what it will take; do nothing"""

    def execute(self) -> Result:
        """Run the jobs, or write what a scheduler takes."""
        from vcage.campaigns.estimate import Estimate
        from vcage.campaigns.folder import CampaignFolder
        from vcage.campaigns.impossible import require_readable
        from vcage.campaigns.plan import Plan

        self._require_one_driver()
        plan, folder = Plan.load(self.plan), CampaignFolder(self.out)
        folder.require_fit(plan)
        require_readable(self.plan, plan, folder.earlier)
        plan = plan.with_robots(folder.earlier)
        if self.dry_run:
            found = Estimate.of(plan, folder, folder.failed(plan, self._share()) if self.retry else ())
            return Result(output=folder.root, summary=found.facts(), text=found.text(), next=not_dry())
        if self.slurm or self.k8s:
            return self._for_scheduler(plan, folder)
        folder.begin(plan)
        if self.retry and (count := folder.forget_failed(self._share())):
            logger.info("%d jobs are tried again", count)
        with progress("campaign") as show:
            schedule = self._drive(folder, show)
        return self._report(schedule)

    def _require_one_driver(self) -> None:
        """Refuse several options that each share the jobs out, and a retry where no job is run.

        Raises:
            UsageError: more than one is given, or ``--retry`` with one that writes a script.
        """
        ways = {"--ray": self.ray, "--shard": self.shard, "--slurm": self.slurm, "--k8s": self.k8s}
        given = [name for name, value in ways.items() if value is not None]
        if len(given) > 1:
            raise UsageError(
                f"{' and '.join(given)} cannot be given together: each shares the jobs out itself",
                hint=f"leave out {' and '.join(given[1:])}",
            )
        if self.retry and (self.slurm or self.k8s):
            raise UsageError(
                f"--retry and {given[0]} cannot be given together: {given[0]} runs no job",
                hint=f"run the command with --retry and without {given[0]} first, or leave out --retry",
            )

    def _report(self, schedule: Schedule) -> Result:
        """The state of the campaign after this driver, and what to do next."""
        from vcage.campaigns.schedule import left_over
        from vcage.campaigns.status import status_of, write_page

        folder = schedule.folder
        status = status_of(folder)
        error = left_over(schedule) or (None if self.shard else _too_few(status, folder))
        output, facts = folder.root, status.facts()
        try:
            output = write_page(folder, status)
        except (DiskFull, OutputFolderError) as fault:
            if error is None:
                raise
            logger.warning("%s", fault.message)  # the error says more
        if error is not None:
            return Result(error=error, facts={"output": str(output), "summary": facts})
        several = ["--group"] if len(schedule.plan.robots) > 1 else []
        merge = vcage_command("merge", folder.root, "--out", folder.root / "dataset", *several)
        return Result(
            output=output, summary=facts, next=merge if status.ended else vcage_command("status", folder.root)
        )

    def _drive(self, folder: CampaignFolder, show: Progress) -> Schedule:
        """Run jobs until none is left that may begin."""
        from vcage.campaigns.driver import run_here

        if self.ray:
            from vcage.campaigns.on_ray import run_on_ray

            return run_on_ray(folder, self.ray, self.workers, show)
        return run_here(folder, self.workers, self._share(), show)

    def _share(self) -> Shard:
        """The share of the jobs that this command runs."""
        from vcage.campaigns.shard import EVERY_JOB, Shard

        return Shard(*self.shard) if self.shard else EVERY_JOB

    def _for_scheduler(self, plan: Plan, folder: CampaignFolder) -> Result:
        from vcage.campaigns.estimate import Estimate
        from vcage.campaigns.schedulers import ShardedCommand, kubernetes_job, require_path, slurm_script

        require_path(folder.root, "SLURM" if self.slurm else "Kubernetes")
        plan = folder.begin(plan)
        command = tuple(shlex.split(vcage_command("campaign", folder.plan_file, "--out", folder.root)))
        job = ShardedCommand(plan.name, command, folder.root, self.slurm or self.k8s or 1, self.workers or 1)
        if self.slurm:
            text, name, submit = slurm_script(job), "campaign.sbatch", "sbatch"
        else:
            text, name, submit = kubernetes_job(job), "campaign.k8s.yml", "kubectl apply -f"
        path = write_text(folder.root / name, text)
        return Result(
            output=path, summary=Estimate.of(plan, folder).facts(), text=text, next=f"{submit} {shlex.quote(str(path))}"
        )


def _too_few(status: Status, folder: CampaignFolder) -> TooFewVerified | None:
    """The error of a campaign that ended with fewer episodes than asked; None if there are enough."""
    short = [cell for cell in status.cells if cell.verified < cell.asked]
    if not status.ended or not short:
        return None
    return TooFewVerified(
        f"verified {status.total.verified} of {status.total.asked} episodes; {len(short)} of {len(status.cells)} cells "
        f"ended with too few: {short[0].name}: {short[0].state}",
        hint="--retry tries failed jobs again, and larger limits in the plan add others; see",
        command=vcage_command("status", folder.root),
        details={"cells": {cell.name: cell.state for cell in short[:100]}},
    )


@dataclass(frozen=True, kw_only=True)
class CampaignStatus(Command):
    """Report on a campaign: episodes of each cell that are asked for, verified, rejected and left; the cost of models.

    It reads the records of jobs only, so it may be run at any time, on any machine that sees the folder.

    examples:
      vcage status campaigns/desk
      vcage status campaigns/desk --watch --html
    """

    folder: Annotated[Path, FOLDER, Positional, arg(metavar="DIR")]
    """the folder of the campaign"""
    html: Flag = False
    """write status.html too: acceptance, reasons of rejections, errors of the critic, speed, disk"""
    watch: Flag = False
    """repeat until the campaign has ended"""
    every: Annotated[float, between(0.1, 3600, "SECONDS")] = 5.0
    """seconds between two reports"""

    def execute(self) -> Result:
        """Print a table, once or until the end."""
        from vcage.campaigns.folder import CampaignFolder
        from vcage.campaigns.status import status_of, table, write_page

        folder = CampaignFolder(self.folder)
        status = status_of(folder)
        while self.watch and not status.ended:
            if self.html:
                write_page(folder, status, refresh_s=round(max(self.every, 1)))
            print_text(("\033[H\033[2J" if sys.stdout.isatty() else "") + table(status) + "\n")
            time.sleep(self.every)
            status = status_of(folder)
        output = write_page(folder, status) if self.html else folder.root
        summary = status.facts() | {"cells": {cell.name: cell.facts() for cell in status.cells}}
        return Result(output=output, summary=summary, text=table(status))
