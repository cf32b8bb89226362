"""The spending of a run, and its cap."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from vcage.base.errors import ConfigurationError, SpendingCap
from vcage.models.exchange import Message, Question, Reply
from vcage.models.exchanges import Exchanges, Stored
from vcage.models.spending import Cap, Price, Spending, cost, price_of


class Paid:
    """Answers, and states the cost if it has one."""

    def __init__(self, usd: float | None = None, provider: str = "gemini:some"):
        self.provider, self.usd = provider, usd

    def answer(self, question: Question) -> Reply:
        return Reply("yes", tokens_in=1_000_000, tokens_out=500_000, usd=self.usd)


def question(number: int) -> Question:
    return Question("critic", (Message("user", f"question {number}"),), {"type": "object"}, "judge_subtask")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "exchanges"


@pytest.fixture
def prices(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    path = tmp_path / "prices.json"
    path.write_text(json.dumps({"gemini:some": {"input": 2.0, "output": 12.0}}))
    monkeypatch.setenv("VCAGE_PRICE_FILE", str(path))
    return path


@pytest.fixture(autouse=True)
def no_prices(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VCAGE_PRICE_FILE", str(tmp_path / "none.json"))


def keeping(folder: Path, cap: Cap, who: Paid, *, reports: bool = False) -> Stored:
    return Stored(who, Exchanges(folder), spending=Spending(folder, cap, who.provider, reports_cost=reports))


def test_the_cost_of_a_reply_is_its_own_figure_or_tokens_by_price():
    price = Price(input=2, output=12)
    assert cost(Reply(tokens_in=1_000_000, tokens_out=500_000), price) == 8.0
    assert cost(Reply(tokens_in=1_000_000, tokens_out=500_000, usd=0.5), price) == 0.5
    assert cost(Reply(), price) is None
    assert cost(Reply(tokens_in=1), None) is None


def test_an_exchange_keeps_its_cost(folder: Path, prices: Path):
    keeping(folder, Cap(), Paid()).answer(question(1))
    assert Exchanges(folder).all()[0].usd == 8.0


def test_a_run_respects_its_cap_of_answers_including_earlier_calls(folder: Path):
    for number in range(2):
        keeping(folder, Cap(calls=2), Paid()).answer(question(number))
    with pytest.raises(SpendingCap, match="holds 2 answers of models online"):
        keeping(folder, Cap(calls=2), Paid()).answer(question(2))
    assert keeping(folder, Cap(calls=2), Paid()).answer(question(1)).text == "yes", "what is kept costs nothing"


def test_answers_of_an_agent_are_not_paid(folder: Path):
    for number in range(3):
        Stored(Paid(provider="agent"), Exchanges(folder)).answer(question(number))
    keeping(folder, Cap(calls=1), Paid()).answer(question(3))


def test_a_run_asks_no_more_once_the_money_is_spent(folder: Path):
    who = keeping(folder, Cap(usd=0.02), Paid(usd=0.015), reports=True)
    who.answer(question(1))
    who.answer(question(2))
    with pytest.raises(SpendingCap, match=r"0\.0300 USD") as caught:
        who.answer(question(3))
    assert caught.value.exit_code == 4 and "--most-usd" in caught.value.hint


def test_money_is_not_capped_without_a_known_price(folder: Path):
    with pytest.raises(ConfigurationError, match="the price of gemini:some is not known"):
        Spending(folder, Cap(usd=1.0), "gemini:some").check()


def test_a_price_file_that_windows_saved_is_read(prices: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("VCAGE_PRICE_FILE", str(prices))
    prices.write_bytes(b'\xef\xbb\xbf{"gemini:some":\r\n{"input": 1, "output": 2}}')
    price = price_of("gemini:some")
    assert price is not None and price.output == 2


@pytest.mark.parametrize(
    "text",
    [
        "{",
        "[]",
        '{"gemini:some": {"input": 1e999, "output": 2}}',
        '{"gemini:some": 3}',
        '{"gemini:some": {"input": -1, "output": 2}}',
    ],
)
def test_a_price_file_that_holds_no_prices_is_named(prices: Path, text: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("VCAGE_PRICE_FILE", str(prices))
    prices.write_text(text)
    with pytest.raises(ConfigurationError, match=r"prices\.json does not hold prices"):
        price_of("gemini:some")
