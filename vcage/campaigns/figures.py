"""Figures of a campaign: of a cell, and of all cells together."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from vcage.base.proportions import wilson
from vcage.campaigns.cells import Standing
from vcage.campaigns.plan import Plan
from vcage.campaigns.record import JobError, JobRecord
from vcage.models.bill import Spent
from vcage.schema.episodes import CriticCounts, Spread


def duration(hours: float) -> str:
    """Return a long time in words: minutes, hours or days."""
    if hours < 1:
        return f"{max(1, 60 * hours):.0f} min"
    return f"{hours:,.1f} h" if hours < 100 else f"{hours / 24:,.1f} days"


@dataclass(frozen=True)
class RunningJob:
    """A job that a process holds.

    Args:
        job: its id.
        holder: the process, as it names itself.
        silent_s: seconds since its last step, by the clocks of this machine and of the file system.
    """

    job: str
    holder: str
    silent_s: float


@dataclass(frozen=True)
class OpenJob:
    """A job that was begun, is not settled and does not run.

    Args:
        job: its id.
        error: that ended its last try.
    """

    job: str
    error: JobError


@dataclass(frozen=True)
class CellStatus:
    """Figures of one cell; of all cells together where ``standing`` is None.

    Args:
        name: id of the cell.
        asked: verified episodes that are wanted.
        records: of its settled jobs.
        running: jobs that run now.
        standing: which of its jobs may begin.
    """

    name: str
    asked: int
    records: Sequence[JobRecord]
    running: int
    standing: Standing | None = None

    @property
    def verified(self) -> int:
        return sum(record.verified for record in self.records)

    @property
    def tried(self) -> int:
        """Episodes that were run."""
        return sum(record.tried for record in self.records)

    @property
    def acceptance(self) -> float | None:
        """Share of accepted episodes; None before the first."""
        return self.verified / self.tried if self.tried else None

    @property
    def interval(self) -> tuple[float, float]:
        """Its Wilson interval at 95 %."""
        return wilson(self.verified, self.tried)

    @property
    def left(self) -> int:
        """Verified episodes that are missing, if any more are looked for."""
        return 0 if self.standing is not None and self.standing.ended else max(0, self.asked - self.verified)

    @property
    def jobs(self) -> Counter[str]:
        """Settled jobs by state."""
        return Counter(record.state for record in self.records)

    @property
    def rejected(self) -> list[tuple[str, int]]:
        """Reasons for which episodes were rejected, the most frequent first."""
        found: Counter[str] = Counter()
        for record in self.records:
            found.update(record.rejected)
        return found.most_common()

    @property
    def per_worker_hour(self) -> float | None:
        """Verified episodes in an hour of one process."""
        seconds = sum(record.seconds for record in self.records)
        return 3600 * self.verified / seconds if seconds else None

    @property
    def cpu_seconds_each(self) -> float | None:
        """CPU seconds per verified episode."""
        return sum(record.cpu_seconds for record in self.records) / self.verified if self.verified else None

    @property
    def bytes(self) -> int:
        return sum(record.bytes for record in self.records)

    @property
    def memory_bytes(self) -> int:
        return max((record.memory_bytes for record in self.records), default=0)

    @cached_property
    def critic(self) -> CriticCounts:
        """The critic against the simulator's truth."""
        return CriticCounts.of(pair for record in self.records if record.critic for pair in _pairs(record.critic))

    @cached_property
    def spread(self) -> dict[str, Spread]:
        """Object → where it started in the verified episodes of all jobs; deviations are those within a job."""
        found: dict[str, list[Spread]] = {}
        for record in self.records:
            for name, spread in record.spread.items():
                found.setdefault(name, []).append(spread)
        return {name: _together(spreads) for name, spreads in sorted(found.items())}

    @property
    def state(self) -> str:
        """One word, or the reason why the cell ended early."""
        if self.standing is not None and self.standing.closed:
            return self.standing.closed
        if self.left == 0:
            return "done" if self.verified >= self.asked else "short"
        return "running" if self.running else "waiting" if not self.records else "begun"

    def facts(self) -> dict[str, Any]:
        """The figures, JSON-serialisable."""
        rate = self.per_worker_hour
        return {
            "asked": self.asked,
            "running": self.running,
            "verified": self.verified,
            "tried": self.tried,
            "rejected": dict(self.rejected),
            "jobs": dict(self.jobs),
            "left": self.left,
            "per_worker_hour": None if rate is None else round(rate, 2),
            "bytes": self.bytes,
            "state": self.state,
        }


@dataclass(frozen=True)
class Status:
    """A campaign at one moment.

    Args:
        plan: of the campaign.
        cells: in the order of the plan.
        running: jobs that processes hold now.
        spent: provider → what its answers cost.
        unread: the errors of records that cannot be read.
        open: jobs whose last try ended with an error, and which may be tried again.
    """

    plan: Plan
    cells: Sequence[CellStatus]
    running: Sequence[RunningJob]
    spent: dict[str, Spent] = field(default_factory=dict)
    unread: Sequence[str] = ()
    open: Sequence[OpenJob] = ()

    @cached_property
    def total(self) -> CellStatus:
        """Figures of all cells."""
        records = [record for cell in self.cells for record in cell.records]
        return CellStatus("all", sum(cell.asked for cell in self.cells), records, len(self.running))

    @property
    def left(self) -> int:
        """Verified episodes that are missing in cells that go on."""
        return sum(cell.left for cell in self.cells)

    @property
    def time_left(self) -> str | None:
        """Until the missing episodes are there, with as many processes as run now; None where that is unknown."""
        rate = self.total.per_worker_hour
        return duration(self.left / rate / len(self.running)) if rate and self.running and self.left else None

    @property
    def ended(self) -> bool:
        return all(cell.standing is None or cell.standing.ended for cell in self.cells)

    @cached_property
    def not_done(self) -> list[JobRecord]:
        """Jobs that failed or were given up."""
        return [record for record in self.total.records if record.state != "done"]

    @property
    def usd(self) -> float:
        return sum(spent.usd for spent in self.spent.values())

    @property
    def calls(self) -> int:
        return sum(spent.calls for spent in self.spent.values())

    def facts(self) -> dict[str, Any]:
        """The figures of the whole, JSON-serialisable."""
        total = self.total.facts() | {"left": self.left, "state": "ended" if self.ended else "open"}
        return total | {
            "calls": self.calls,
            "usd": round(self.usd, 6),
            "not_done": len(self.not_done),
            "unread": len(self.unread),
        }


def _pairs(critic: CriticCounts) -> Iterable[tuple[bool, bool]]:
    """The judged attempts that a count was made of: the critic's answer, and the truth."""
    yield from [(True, True)] * critic.true_accepted + [(True, False)] * critic.false_accepted
    yield from [(False, True)] * critic.false_refused + [(False, False)] * critic.true_refused


def _together(spreads: Sequence[Spread]) -> Spread:
    (x0, y0), (x1, y1), (dx, dy) = (
        tuple(f(getattr(s, side)[axis] for s in spreads) for axis in (0, 1))
        for side, f in (("lower", min), ("upper", max), ("deviation", _quadratic_mean))
    )
    return Spread(lower=(x0, y0), upper=(x1, y1), deviation=(round(dx, 4), round(dy, 4)))


def _quadratic_mean(values: Iterable[float]) -> float:
    found = list(values)
    return math.sqrt(sum(value * value for value in found) / len(found))
