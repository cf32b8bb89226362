"""Exchanges that many runs share: nothing is asked twice in them, on one bill, and each provider at one pace.

The folder may be used by any number of processes, on any number of machines that lock files on their shared disk.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import ClassVar

from vcage.base.files import make_folder, write_text
from vcage.base.hold import one_at_a_time
from vcage.models.bill import Bill
from vcage.models.exchange import Answerer, Question, Reply
from vcage.models.exchanges import Exchanges
from vcage.models.spending import Cap, Spending, cost


@dataclass(frozen=True)
class Shared:
    """Properties that runs share.

    Args:
        folder: of their exchanges, and of their bill.
        cap: limits on models online, of all runs together.
        per_minute: provider → questions a minute, of all runs together.
        sleep: waits for a turn, given seconds.
    """

    folder: Path
    cap: Cap = field(default_factory=Cap)
    per_minute: Mapping[str, float] = field(default_factory=dict)
    sleep: Callable[[float], None] = time.sleep

    @property
    def bill(self) -> Bill:
        """The bill; one object for each file, as it remembers what it has read."""
        return _bill(self.folder / "bill.jsonl")


@lru_cache(maxsize=8)
def _bill(path: Path) -> Bill:
    return Bill(path)


class SharedAnswers:
    """Implements :class:`vcage.models.exchange.Answerer`: looks among the shared answers, else asks another one.

    Args:
        other: the answerer to ask.
        shared: what the runs share.
        paid: the limits apply to it.
        reports_cost: True if its replies state their cost.
    """

    def __init__(self, other: Answerer, shared: Shared, *, paid: bool = True, reports_cost: bool = False):
        self.provider = other.provider
        self._other, self._shared = other, shared
        self._exchanges = Exchanges(shared.folder, shared.bill.count)
        cap = shared.cap if paid else Cap()
        self._spending = _SharedSpending(shared.bill, cap, self.provider, reports_cost=reports_cost)
        name = self.provider.partition(":")[0]
        rate = shared.per_minute.get(name)
        self._pace = None if rate is None else Pace(shared.folder / f"pace-{name}", 60.0 / rate, shared.sleep)

    def answer(self, question: Question) -> Reply:
        """The shared answer, or else a new one, which is shared from then on.

        A process that asks the same question waits for the answer of the one that asks it.

        Raises:
            SpendingCap: a limit is reached.
            VcageError: as the other one.
        """
        locks = self._shared.folder / "locks"
        make_folder(locks)
        with one_at_a_time(locks / question.hash[:2]):
            if (stored := self._exchanges.find(question, self.provider)) is not None:
                return stored
            return self._asked(question)

    def _asked(self, question: Question) -> Reply:
        bill, name = self._shared.bill, question.hash
        with bill.locked():
            self._spending.check()
            bill.append("asked", self.provider, name, role=question.role, prompt=question.name)
        if self._pace is not None:
            self._pace.wait()
        start = time.perf_counter()
        try:
            reply = self._other.answer(question)
        except Exception:
            with bill.locked():
                bill.append("failed", self.provider, name)
            raise
        seconds, usd = time.perf_counter() - start, cost(reply, self._spending.price)
        with bill.locked():
            counted = {"usd": usd, "tokens_in": reply.tokens_in, "tokens_out": reply.tokens_out}
            bill.append("answered", self.provider, name, **counted)
            self._exchanges.store(question, reply, self.provider, seconds, usd)
        return replace(reply, usd=usd)


class _SharedSpending(Spending):
    """The money that all runs have spent."""

    OF: ClassVar[str] = "campaign"
    CALLS: ClassVar[str] = "limits.calls in its plan"
    USD: ClassVar[str] = "limits.usd in its plan"

    def __init__(self, bill: Bill, cap: Cap, provider: str, *, reports_cost: bool):
        super().__init__(bill.path.parent, cap, provider, reports_cost=reports_cost)
        self._bill = bill

    def _spent(self) -> tuple[int, float]:
        sums = self._bill.refresh().values()
        return sum(spent.calls for spent in sums), sum(spent.usd for spent in sums)


class Pace:
    """Turns of questions, at equal intervals over all processes.

    Args:
        path: of the file with the time of the last turn.
        interval_s: between two turns.
        sleep: waits for one.
        most_ahead: a last turn that lies more turns ahead than there may be processes comes from a clock that jumped,
            and does not count.
    """

    def __init__(
        self, path: Path, interval_s: float, sleep: Callable[[float], None] = time.sleep, most_ahead: int = 1000
    ):
        self._path, self._interval_s, self._sleep = path, interval_s, sleep
        self._most_ahead_s = most_ahead * interval_s

    def wait(self) -> None:
        """Take the next turn, and wait for it."""
        now = time.time()
        make_folder(self._path.parent)
        with one_at_a_time(self._path):
            last = self._last()
            turn = max(now, last + self._interval_s) if last - now <= self._most_ahead_s else now
            write_text(self._path, f"{turn!r}\n")
        if turn > now:
            self._sleep(turn - now)

    def _last(self) -> float:
        try:
            return float(self._path.read_text(encoding="utf-8"))
        except (FileNotFoundError, ValueError):
            return float("-inf")
