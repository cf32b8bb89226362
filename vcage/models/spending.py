"""The cost of asking models, and limits on it: on the number of questions of a run, and on their price.

Prices change, so none are stored here. OpenRouter reports the cost with each reply; for the others
``$VCAGE_PRICE_FILE``, else ``~/.config/vcage/prices.json``, holds the prices of their lists, in US dollars per million
tokens: ``{"gemini:gemini-pro-latest": {"input": 2.0, "output": 12.0}}``.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from pydantic import Field

from vcage.base.errors import ConfigurationError, SpendingCap
from vcage.models.exchange import Reply
from vcage.models.keys import read_user_file, user_file
from vcage.schema.base import Finite, Record
from vcage.schema.exchange import Exchange


class Price(Record):
    """US dollars per million tokens, asked and answered."""

    input: Finite = Field(ge=0)
    output: Finite = Field(ge=0)


def price_file() -> Path:
    """The file of prices."""
    return user_file("VCAGE_PRICE_FILE", "prices.json")


def price_of(provider: str) -> Price | None:
    """The price of ``provider:model``; None if the file does not have it, or there is no file.

    Raises:
        ConfigurationError: the file does not hold prices.
    """
    example = '{"gemini:gemini-pro-latest": {"input": 2, "output": 12}}, USD per million tokens'
    return read_user_file(price_file(), Price, what="prices", example=example).get(provider)


def cost(reply: Reply, price: Price | None) -> float | None:
    """US dollars: as the reply reports them, else tokens by price; None if neither is known."""
    if reply.usd is not None or price is None or reply.tokens_in is None:
        return reply.usd
    return (reply.tokens_in * price.input + (reply.tokens_out or 0) * price.output) / 1e6


@dataclass(frozen=True)
class Cap:
    """Limits on a run: how often it may ask models online, and for how many US dollars; None is no limit."""

    calls: int | None = None
    usd: float | None = None


class Spending:
    """The money that a run has spent on models online, in all processes.

    Args:
        folder: of its exchanges.
        cap: its limits.
        provider: the paid one, ``gemini:gemini-pro-latest``.
        reports_cost: True if its replies state their cost.

    Raises:
        ConfigurationError: the file of prices cannot be used.
    """

    OF: ClassVar[str] = "run"
    CALLS: ClassVar[str] = "--most-calls"
    USD: ClassVar[str] = "--most-usd"
    """The source of the limits, for errors."""

    def __init__(self, folder: Path, cap: Cap, provider: str, *, reports_cost: bool = False):
        self.price = price_of(provider)
        self._folder, self._cap = folder, cap
        self._seen: dict[str, Exchange] = {}
        self._provider, self._reports_cost = provider, reports_cost

    def check(self) -> None:
        """Refuse to go on at a limit.

        Raises:
            ConfigurationError: money is limited, and the provider's price is not known.
            SpendingCap: a limit is reached; states the amount spent.
            DamagedFile, SchemaMismatch: an exchange cannot be read.
        """
        if self._cap.usd is not None and self.price is None and not self._reports_cost:
            wanted = f'{{"{self._provider}": {{"input": …, "output": …}}}}'
            raise ConfigurationError(
                f"the price of {self._provider} is not known, so {self.USD} cannot be kept",
                hint=f"write {wanted}, in USD per million tokens, to {price_file()}",
            )
        calls, usd = self._spent()
        if self._cap.calls is not None and calls >= self._cap.calls:
            raise self._reached(f"{calls} answers of models online", self.CALLS, calls, usd)
        if self._cap.usd is not None and usd >= self._cap.usd:
            raise self._reached(f"answers for {usd:.4f} USD", self.USD, calls, usd)

    def _spent(self) -> tuple[int, float]:
        """The number of answers from models online, and US dollars for them."""
        for path in self._folder.glob("*.json"):
            if path.name not in self._seen:
                self._seen[path.name] = Exchange.read(path)
        paid = [exchange for exchange in self._seen.values() if exchange.online]
        return len(paid), sum(exchange.usd or 0.0 for exchange in paid)

    def _reached(self, spent: str, option: str, calls: int, usd: float) -> SpendingCap:
        return SpendingCap(
            f"the {self.OF} holds {spent}, which is its limit",
            hint=f"repeat the command with a larger {option}: stored answers are reused",
            details={"calls": calls, "usd": usd, "cap": {"calls": self._cap.calls, "usd": self._cap.usd}},
        )
