"""What asking models costs, and an end to it: a run asks so often, and for so much money, and no more.

Prices are facts of a day, so there are none here. OpenRouter tells with each reply what it cost; for the others
``$VCAGE_PRICE_FILE``, else ``~/.config/vcage/prices.json``, holds what their price lists say, in US dollars per million
tokens: ``{"gemini:gemini-pro-latest": {"input": 2.0, "output": 12.0}}``.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from pydantic import Field, TypeAdapter, ValidationError

from vcage.base.errors import ConfigurationError, InputFileError, MissingStage, SpendingCap
from vcage.base.reading import read_json
from vcage.models.exchange import Reply
from vcage.schema.base import Finite, Record
from vcage.schema.exchange import Exchange


class Price(Record):
    """US dollars per million tokens, asked and answered."""

    input: Finite = Field(ge=0)
    output: Finite = Field(ge=0)


def price_file() -> Path:
    """Where prices are looked up."""
    return Path(os.environ.get("VCAGE_PRICE_FILE") or Path.home() / ".config" / "vcage" / "prices.json")


def price_of(provider: str) -> Price | None:
    """The price of ``provider:model``; None where the file does not know it, or is not there.

    Raises:
        ConfigurationError: the file is there, and does not hold prices.
    """
    path = price_file()
    try:
        data = read_json(path)
    except MissingStage:
        return None
    except InputFileError as error:
        raise ConfigurationError(f"{path} holds no prices: {error.message}", hint="mend or remove it") from error
    try:
        return TypeAdapter(dict[str, Price]).validate_python(data).get(provider)
    except ValidationError as error:
        raise ConfigurationError(
            f"{path} holds no prices: {error.errors()[0]['msg']}",
            hint='it holds JSON like {"gemini:gemini-pro-latest": {"input": 2, "output": 12}}, USD per million tokens',
        ) from error


def cost(reply: Reply, price: Price | None) -> float | None:
    """US dollars: what the reply says, else tokens by price; None where neither is known."""
    if reply.usd is not None or price is None or reply.tokens_in is None:
        return reply.usd
    return (reply.tokens_in * price.input + (reply.tokens_out or 0) * price.output) / 1e6


@dataclass(frozen=True)
class Cap:
    """How often a run may ask models online, and for how much in all; None is without end."""

    calls: int | None = None
    usd: float | None = None


class Spending:
    """What a run has spent on models online, in whatever process.

    Args:
        folder: of its exchanges.
        cap: what it may spend.
        provider: who is paid now, ``gemini:gemini-pro-latest``.
        tells: its replies say what they cost.

    Raises:
        ConfigurationError: the file of prices holds none.
    """

    def __init__(self, folder: Path, cap: Cap, provider: str, *, tells: bool = False):
        self.price = price_of(provider)
        self._folder, self._cap = folder, cap
        self._seen: dict[str, Exchange] = {}
        self._provider, self._tells = provider, tells

    def check(self) -> None:
        """Make sure that there is something left.

        Raises:
            ConfigurationError: money is capped, and what the provider takes is not known.
            SpendingCap: there is not; says what was spent.
            DamagedFile, SchemaMismatch: an exchange cannot be read.
        """
        if self._cap.usd is not None and self.price is None and not self._tells:
            wanted = f'{{"{self._provider}": {{"input": …, "output": …}}}}'
            raise ConfigurationError(
                f"what {self._provider} costs is not known, so --most-usd cannot be kept",
                hint=f"write {wanted}, in USD per million tokens, to {price_file()}",
            )
        for path in self._folder.glob("*.json"):
            if path.name not in self._seen:
                self._seen[path.name] = Exchange.read(path)
        paid = [exchange for exchange in self._seen.values() if exchange.online]
        usd = sum(exchange.usd or 0.0 for exchange in paid)
        if self._cap.calls is not None and len(paid) >= self._cap.calls:
            told, option = f"{len(paid)} answers of models online", "--most-calls"
        elif self._cap.usd is not None and usd >= self._cap.usd:
            told, option = f"answers for {usd:.4f} USD", "--most-usd"
        else:
            return
        raise SpendingCap(
            f"the run holds {told}, as many as it may",
            hint=f"run it again with a larger {option}: what was answered is not asked again",
            details={"calls": len(paid), "usd": usd, "cap": {"calls": self._cap.calls, "usd": self._cap.usd}},
        )
