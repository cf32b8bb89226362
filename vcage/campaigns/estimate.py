"""Estimate of a plan: CPU hours, hours, bytes, files, memory and money, from the measured cost of an episode."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import Any

import yaml

from vcage.campaigns.figures import Status, duration
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.plan import Job, Plan
from vcage.campaigns.status import status_of

MEASURED = Path(__file__).with_name("unit_costs.yml")
"""The costs of an episode where a campaign has none of its own yet."""

CORES = (16, 256, 4096)
"""Numbers of cores for which the time is given, each busy all the time; or one for each job, where there are fewer."""


@dataclass(frozen=True)
class UnitCosts:
    """The cost of one verified episode, with its share of the rejected ones and of the stages before and after.

    Args:
        source: which episodes, where and when.
        cpu_seconds: of all processes.
        bytes, files: of its share of the run folder; files are files and folders.
        memory_bytes: largest, of a process.
        calls, usd: answers of models online, and their cost; None where no model was asked.
    """

    source: str
    cpu_seconds: float
    bytes: float
    files: float
    memory_bytes: float
    calls: float | None = None
    usd: float | None = None

    @classmethod
    def measured(cls) -> UnitCosts:
        """Return those that come with vcage."""
        return cls(**yaml.safe_load(MEASURED.read_text(encoding="utf-8")))

    @classmethod
    def of(cls, status: Status) -> UnitCosts | None:
        """Return those of a campaign so far; None before its first verified episode."""
        total = status.total
        count = total.verified
        if not count:
            return None
        return cls(
            source=f"{count} verified episodes of this campaign",
            cpu_seconds=sum(record.cpu_seconds for record in total.records) / count,
            bytes=total.bytes / count,
            files=sum(record.files for record in total.records) / count,
            memory_bytes=total.memory_bytes,
            calls=status.calls / count if status.spent else None,
            usd=status.usd / count if status.spent else None,
        )


@dataclass(frozen=True)
class Estimate:
    """The size of a plan, and the cost of an episode.

    Args:
        plan: of the campaign.
        asked: verified episodes; of a scene that is done whole one, or more once a job has counted its sub-tasks.
        left: those that are not there yet, in cells that go on.
        costs: of one more.
        again: jobs that are tried again.
    """

    plan: Plan
    asked: int
    left: int
    costs: UnitCosts
    again: int = 0

    @classmethod
    def of(cls, plan: Plan, folder: CampaignFolder, again: Collection[Job] = ()) -> Estimate:
        """Estimate what is left of a plan in a folder, which need not exist.

        Args:
            plan: to go on with.
            folder: of the campaign.
            again: settled jobs that are to be tried again.
        """
        if folder.earlier is None:
            asked = len(plan.cells) * plan.episodes
            return cls(plan, asked, asked, UnitCosts.measured())
        status = status_of(folder, plan, {job.id for job in again})
        costs = UnitCosts.of(status) or UnitCosts.measured()
        return cls(plan, status.total.asked, status.left, costs, len(again))

    @property
    def jobs(self) -> int:
        """Jobs that are sure to be needed."""
        return len(self.plan.cells) * ceil(self.plan.episodes / self.plan.episodes_per_job)

    @property
    def jobs_left(self) -> int:
        """The fewest jobs for the episodes that are left."""
        return ceil(self.left / self.plan.episodes_per_job)

    def facts(self) -> dict[str, Any]:
        """The figures, JSON-serialisable."""
        costs, left = self.costs, self.left
        return {
            "cells": len(self.plan.cells),
            "jobs": self.jobs,
            "episodes": self.asked,
            "left": left,
            "tried_again": self.again,
            "cpu_hours": round(left * costs.cpu_seconds / 3600, 2),
            "bytes": round(left * costs.bytes),
            "files": round(left * costs.files),
            "memory_bytes_per_process": round(costs.memory_bytes),
            "calls": None if costs.calls is None else round(left * costs.calls),
            "usd": None if costs.usd is None else round(left * costs.usd, 2),
            "unit_costs": costs.source,
        }

    def text(self) -> str:
        """The figures as a table for people."""
        costs, found = self.costs, self.facts()
        hours = found["cpu_hours"]
        rows = [
            ("", "an episode", "all that are left"),
            ("CPU", f"{costs.cpu_seconds:.1f} s", f"{hours:,.1f} h"),
            *((f"on {n} cores", "", duration(hours / max(1, min(n, self.jobs_left)))) for n in CORES),
            ("disk", _size(costs.bytes), _size(found["bytes"])),
            ("files and folders", f"{costs.files:.1f}", f"{found['files']:,}"),
            ("memory of a process", "", _size(costs.memory_bytes)),
            ("answers of models", _number(costs.calls, 2), _number(found["calls"], 0)),
            ("models, USD", _number(costs.usd, 4), _number(found["usd"], 2)),
            ("GPU", "not measured", "not measured"),
        ]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = ["  ".join((name.ljust(widths[0]), *map(str.rjust, cells, widths[1:]))) for name, *cells in rows]
        many = " (of a scene that is done whole, more)" if any(task.all_subtasks for task in self.plan.tasks) else ""
        head = f"{self.plan.name}: {found['cells']:,} cells, {found['jobs']:,} jobs, {found['episodes']:,} episodes"
        again = f", jobs to be tried again: {self.again:,}" if self.again else ""
        above = [f"{head}{many}, {found['left']:,} left{again}", f"unit costs: {costs.source}", ""]
        return "\n".join([*above, *lines])


def _size(count: float) -> str:
    unit, name = next((u, n) for u, n in ((1e12, "TB"), (1e9, "GB"), (1e6, "MB"), (0, "MB")) if count >= u)
    return f"{count / (unit or 1e6):,.1f} {name}"


def _number(value: float | None, digits: int) -> str:
    return "none asked" if value is None else f"{value:,.{digits}f}"
