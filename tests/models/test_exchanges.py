"""Exchanges are kept, looked up and replayed."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from vcage.base.errors import DamagedFile, InputFileError, MissingStage
from vcage.models.exchange import Message, Question, Reply
from vcage.models.exchanges import Exchanges, Replayed, Stored, who_answered

PICTURE = np.arange(48, dtype=np.uint8).reshape(4, 4, 3)
ASKED = Question("reasoner", (Message("user", "which?", (PICTURE,)),), {"type": "object"}, "select_assets")


class Counting:
    """Answers, and counts how often."""

    provider = "counting:one"

    def __init__(self, reply: Reply):
        self.reply, self.times = reply, 0

    def answer(self, question: Question) -> Reply:
        self.times += 1
        return self.reply


@pytest.fixture
def exchanges(tmp_path: Path) -> Exchanges:
    return Exchanges(tmp_path / "exchanges")


def test_an_answered_question_is_not_asked_again(exchanges: Exchanges) -> None:
    other = Counting(Reply("yes", model="one-2026", tokens_in=7, tokens_out=2))
    first = Stored(other, exchanges).answer(ASKED)
    assert Stored(other, exchanges).answer(ASKED) == first == other.reply
    assert other.times == 1


def test_a_question_is_asked_again_on_request(exchanges: Exchanges) -> None:
    other = Counting(Reply("yes"))
    for _ in range(2):
        Stored(other, exchanges, anew=True).answer(ASKED)
    assert other.times == 2


def test_a_picture_comes_back_as_it_was(exchanges: Exchanges) -> None:
    drawn = Question("editor", ASKED.messages, None, "rearrange")
    Stored(Counting(Reply(picture=PICTURE[::-1])), exchanges).answer(drawn)
    found = exchanges.find(drawn, "counting:one")
    assert found is not None and np.array_equal(found.picture, PICTURE[::-1])


@pytest.mark.parametrize(
    "changed",
    [
        Question("critic", ASKED.messages, ASKED.schema, ASKED.name),
        Question("reasoner", (Message("user", "what?", (PICTURE,)),), ASKED.schema, ASKED.name),
        Question("reasoner", (Message("user", "which?", (PICTURE + 1,)),), ASKED.schema, ASKED.name),
        Question("reasoner", ASKED.messages, {"type": "array"}, ASKED.name),
        ASKED.again(Reply("no"), "why not?"),
    ],
    ids=["role", "words", "picture", "schema", "round"],
)
def test_another_question_is_another_exchange(exchanges: Exchanges, changed: Question) -> None:
    Stored(Counting(Reply("yes")), exchanges).answer(ASKED)
    assert exchanges.find(changed, "counting:one") is None


def test_a_replay_answers_the_recorded_questions_and_names_the_missing_ones(exchanges: Exchanges) -> None:
    Stored(Counting(Reply("yes")), exchanges).answer(ASKED)
    assert who_answered(exchanges) == {"reasoner": "counting:one"}
    replayed = Replayed(exchanges, "counting:one")
    assert replayed.answer(ASKED).text == "yes"
    with pytest.raises(MissingStage, match="select_assets, round 2"):
        replayed.answer(ASKED.again(Reply("no"), "why not?"))


def test_the_record_holds_the_whole_exchange(exchanges: Exchanges) -> None:
    Stored(Counting(Reply("yes", model="one-2026", tokens_in=7)), exchanges).answer(ASKED.again(Reply("no"), "hm"))
    (kept,) = exchanges.all()
    assert [(turn.speaker, turn.text) for turn in kept.turns] == [("user", "which?"), ("model", "no"), ("user", "hm")]
    assert (kept.provider, kept.model, kept.answer, kept.tokens_in, kept.tokens_out) == (
        "counting:one", "one-2026", "yes", 7, None,
    )  # fmt: skip
    assert (exchanges.folder / "pictures" / kept.turns[0].pictures[0]).is_file()


def test_a_damaged_record_is_named(exchanges: Exchanges) -> None:
    Stored(Counting(Reply("yes")), exchanges).answer(ASKED)
    (path,) = exchanges.folder.glob("*.json")
    path.write_text("{")
    with pytest.raises(DamagedFile, match=path.name):
        exchanges.find(ASKED, "counting:one")
    with pytest.raises(DamagedFile, match=path.name) as caught:
        exchanges.all()
    assert "remove it" in caught.value.hint


def test_exchanges_keep_the_order_of_their_first_storage(exchanges: Exchanges) -> None:
    later = ASKED.again(Reply("no"), "why not?")
    for question in (ASKED, later, ASKED):
        Stored(Counting(Reply("yes")), exchanges, anew=True).answer(question)
    assert [exchange.round for exchange in exchanges.all()] == [1, 2]


@pytest.mark.parametrize(("field", "value"), [("answer", "no"), ("hash", "0" * 64), ("provider", "somebody:else")])
def test_an_exchange_that_was_edited_is_not_repeated(exchanges: Exchanges, field: str, value: str) -> None:
    Stored(Counting(Reply("yes")), exchanges).answer(ASKED)
    (path,) = exchanges.folder.glob("*.json")
    record = json.loads(path.read_text())
    path.write_text(json.dumps(record | {field: value}))
    with pytest.raises(InputFileError, match="was edited"):
        Replayed(exchanges, "counting:one").answer(ASKED)
