"""Exchanges that many runs share: nothing is asked twice, one bill, one pace."""

from __future__ import annotations

import json
import threading
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.model_server import ModelServer, text_answer
from vcage.base.errors import ConfigurationError, EndpointFailed, SpendingCap
from vcage.base.workers import Processes
from vcage.models.bill import Bill
from vcage.models.exchange import Message, Question, Reply
from vcage.models.exchanges import Exchanges, Stored
from vcage.models.registry import Choice
from vcage.models.shared import Pace, Shared, SharedAnswers
from vcage.models.spending import Cap


class Model:
    """Answers, takes its time, notes each question in a file, and fails where it is told to."""

    provider = "gemini:some"

    def __init__(self, log: Path, usd: float | None = 0.25, seconds: float = 0.0, fails: bool = False):
        self._log, self._usd, self._seconds, self._fails = log, usd, seconds, fails

    def answer(self, question: Question) -> Reply:
        time.sleep(self._seconds)
        with open(self._log, "a") as log:
            log.write(f"{question.messages[0].text}\n")
        if self._fails:
            raise EndpointFailed("it does not answer")
        return Reply("yes", tokens_in=10, tokens_out=2, usd=self._usd)


NONE = Cap()


def question(number: int) -> Question:
    return Question("critic", (Message("user", f"question {number}"),), {"type": "object"}, "judge_subtask")


def asked(log: Path) -> list[str]:
    return log.read_text().splitlines() if log.exists() else []


@pytest.fixture(autouse=True)
def no_prices(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VCAGE_PRICE_FILE", str(tmp_path / "none.json"))


@pytest.fixture
def log(tmp_path: Path) -> Path:
    return tmp_path / "asked.log"


def of_run(tmp_path: Path, name: str, model: Model, cap: Cap = NONE, paid: bool = True) -> Stored:
    """The answerer of one run of a campaign."""
    shared = Shared(tmp_path / "shared", cap)
    return Stored(SharedAnswers(model, shared, paid=paid, reports_cost=True), Exchanges(tmp_path / name))


def test_a_question_of_one_run_is_not_asked_again_in_another(tmp_path: Path, log: Path):
    for name in ("one", "two"):
        assert of_run(tmp_path, name, Model(log)).answer(question(1)).text == "yes"
    assert asked(log) == ["question 1"]


def test_every_run_keeps_the_exchange_and_its_cost_but_the_bill_counts_it_once(tmp_path: Path, log: Path):
    for name in ("one", "two"):
        of_run(tmp_path, name, Model(log)).answer(question(1))
    kept = [Exchanges(tmp_path / name).all()[0] for name in ("one", "two")]
    assert [(exchange.usd, exchange.tokens_in, exchange.number) for exchange in kept] == [(0.25, 10, 1)] * 2
    spent = Bill(tmp_path / "shared" / "bill.jsonl").refresh()["gemini:some"]
    assert (spent.calls, spent.usd, spent.tokens_in, spent.tokens_out) == (1, 0.25, 10, 2)


def test_limits_hold_over_all_runs(tmp_path: Path, log: Path):
    of_run(tmp_path, "one", Model(log), Cap(calls=2)).answer(question(1))
    of_run(tmp_path, "two", Model(log), Cap(calls=2)).answer(question(2))
    with pytest.raises(SpendingCap, match="the campaign holds 2 answers of models online") as refused:
        of_run(tmp_path, "three", Model(log), Cap(calls=2)).answer(question(3))
    assert "limits.calls in its plan" in refused.value.hint
    assert of_run(tmp_path, "three", Model(log), Cap(calls=2)).answer(question(1)).text == "yes"
    assert len(asked(log)) == 2


def test_money_of_all_runs_is_limited(tmp_path: Path, log: Path):
    for number in (1, 2):
        of_run(tmp_path, f"run{number}", Model(log), Cap(usd=0.5)).answer(question(number))
    with pytest.raises(SpendingCap, match=r"0\.5000 USD"):
        of_run(tmp_path, "run3", Model(log), Cap(usd=0.5)).answer(question(3))


def test_money_cannot_be_limited_where_no_price_is_known(tmp_path: Path, log: Path):
    answers = SharedAnswers(Model(log, usd=None), Shared(tmp_path / "shared", Cap(usd=1.0)))
    with pytest.raises(ConfigurationError, match=r"so limits\.usd in its plan cannot be kept"):
        answers.answer(question(1))
    assert asked(log) == []


def test_a_free_server_is_on_the_bill_and_has_no_limit(tmp_path: Path, log: Path):
    for number in range(3):
        of_run(tmp_path, "one", Model(log, usd=None), Cap(calls=1), paid=False).answer(question(number))
    assert Bill(tmp_path / "shared" / "bill.jsonl").refresh()["gemini:some"].calls == 3


def test_a_question_without_an_answer_costs_nothing_and_may_be_asked_again(tmp_path: Path, log: Path):
    with pytest.raises(EndpointFailed):
        of_run(tmp_path, "one", Model(log, fails=True), Cap(calls=1)).answer(question(1))
    assert of_run(tmp_path, "one", Model(log), Cap(calls=1)).answer(question(1)).text == "yes"


def ask_all(task: tuple[Path, Path, str, int]) -> str:
    """Ask five questions in a run, from another one on in each."""
    tmp_path, log, run, first = task
    answerer = of_run(tmp_path, run, Model(log, seconds=0.05), Cap(calls=5))
    return "".join(answerer.answer(question((first + n) % 5)).text for n in range(5))


@pytest.mark.slow
def test_processes_that_ask_the_same_at_once_ask_once(tmp_path: Path, log: Path):
    with Processes(ask_all, 4) as crew:
        for number in range(4):
            crew.submit((tmp_path, log, f"run{number}", number))
        assert list(crew.results()) == ["yes" * 5] * 4
    assert Counter(asked(log)) == Counter(f"question {number}" for number in range(5))
    assert Bill(tmp_path / "shared" / "bill.jsonl").refresh()["gemini:some"].calls == 5


def test_a_limit_of_calls_is_not_overrun_by_processes_at_once(tmp_path: Path, log: Path):
    ends, start = [], threading.Barrier(4)

    def ask(number: int) -> None:
        start.wait()
        try:
            ends.append(
                of_run(tmp_path, f"run{number}", Model(log, seconds=0.2), Cap(calls=2)).answer(question(number))
            )
        except SpendingCap as error:
            ends.append(error)

    threads = [threading.Thread(target=ask, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert Counter(type(end).__name__ for end in ends) == {"Reply": 2, "SpendingCap": 2}


def test_a_line_of_the_bill_that_was_cut_off_is_passed_over(tmp_path: Path, log: Path):
    of_run(tmp_path, "one", Model(log)).answer(question(1))
    path = tmp_path / "shared" / "bill.jsonl"
    with open(path, "a") as handle:
        handle.write('{"what": "asked", "provi')
    assert Bill(path).refresh()["gemini:some"].calls == 1
    of_run(tmp_path, "one", Model(log)).answer(question(2))
    assert Bill(path).refresh()["gemini:some"].calls == 2
    assert [json.loads(line)["what"] for line in path.read_text().splitlines() if line.endswith("}")] == [
        *["asked", "answered"],
        *["asked", "answered"],
    ]


def test_a_question_that_was_under_way_when_its_process_was_killed_is_on_the_bill(tmp_path: Path, log: Path):
    class Killed(Model):
        def answer(self, question: Question) -> Reply:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        of_run(tmp_path, "one", Killed(log)).answer(question(1))
    assert Bill(tmp_path / "shared" / "bill.jsonl").refresh()["gemini:some"].calls == 1
    assert of_run(tmp_path, "two", Model(log)).answer(question(1)).text == "yes"


def test_an_edited_shared_answer_is_refused(tmp_path: Path, log: Path):
    of_run(tmp_path, "one", Model(log)).answer(question(1))
    (path,) = (tmp_path / "shared").glob("critic-*.json")
    path.write_text(path.read_text().replace('"yes"', '"no"'))
    with pytest.raises(Exception, match="was edited"):
        of_run(tmp_path, "two", Model(log)).answer(question(1))


def test_runs_of_one_choice_share_what_a_provider_answers(
    tmp_path: Path, server: ModelServer, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("VCAGE_GEMINI_API_KEY", server.key)
    monkeypatch.setenv("VCAGE_GEMINI_BASE_URL", server.base_urls["gemini"])
    server.queue(text_answer('{"accepted": true}'))
    for name in ("one", "two"):
        choice = Choice("gemini", run=tmp_path / name, shared=Shared(tmp_path / "shared"))
        answerer = choice.answerer("critic")
        assert answerer is not None and answerer.answer(question(1)).text == '{"accepted": true}'
    assert len(server.requests) == 1


# --- pace --------------------------------------------------------------------------------------------------


@pytest.fixture
def waits(monkeypatch: pytest.MonkeyPatch) -> tuple[Callable[[float], None], list[float], list[float]]:
    """A clock that stands still but for what is waited; how long was waited; the clock."""
    now, waited = [1000.0], list[float]()
    monkeypatch.setattr(time, "time", lambda: now[0])

    def sleep(seconds: float) -> None:
        waited.append(seconds)

    return sleep, waited, now


def test_questions_of_all_processes_take_turns_at_equal_intervals(tmp_path: Path, waits):
    sleep, waited, now = waits
    for _ in range(3):
        Pace(tmp_path / "pace", 2.0, sleep).wait()
    now[0] += 100
    Pace(tmp_path / "pace", 2.0, sleep).wait()
    assert waited == [2.0, 4.0]


def test_a_clock_that_jumped_back_lets_nobody_wait_for_hours(tmp_path: Path, waits):
    sleep, waited, now = waits
    Pace(tmp_path / "pace", 2.0, sleep).wait()
    now[0] -= 7200
    Pace(tmp_path / "pace", 2.0, sleep).wait()
    assert waited == []


def test_a_provider_with_a_rate_is_asked_in_turns(tmp_path: Path, log: Path):
    waited: list[float] = []
    shared = Shared(tmp_path / "shared", per_minute={"gemini": 30}, sleep=waited.append)
    answers = SharedAnswers(Model(log), shared, reports_cost=True)
    for number in (1, 2, 1):
        answers.answer(question(number))
    assert len(waited) == 1 and 1.0 < waited[0] <= 2.0
