from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import pytest
from pydantic import Field

from vcage.base.errors import ModelRefused
from vcage.models.exchange import Message, Question, Reply
from vcage.models.prompts import Prompt
from vcage.models.structured import Answer, ask, flat_schema, json_of, one_of, one_or_none


class Colour(Answer):
    name: one_of(["red", "blue"])


class Script:
    """Answers with the given texts, one after another, and keeps what it was sent."""

    provider = "script"

    def __init__(self, *texts: str):
        self.texts = list(texts)
        self.sent: list[Sequence[Message]] = []

    def answer(self, question: Question) -> Reply:
        self.sent.append(question.messages)
        return Reply(self.texts.pop(0))


PROMPT = Prompt("choose", "colour?")


def test_a_valid_answer_is_taken_at_once() -> None:
    assert ask(Script('{"name": "red"}'), "reasoner", PROMPT, Colour).name == "red"


@pytest.mark.parametrize(
    "text", ['```json\n{"name": "red"}\n```', 'Sure: {"name": "red"} as you like', ' {"name":"red"}']
)
def test_json_is_found_in_fences_and_prose(text: str) -> None:
    assert ask(Script(text), "reasoner", PROMPT, Colour).name == "red"


def test_an_answer_against_the_schema_goes_back_with_the_exact_complaint() -> None:
    chat = Script('{"name": "green"}', '{"name": "blue"}')
    assert ask(chat, "reasoner", PROMPT, Colour).name == "blue"
    first, answer, complaint = chat.sent[1]
    assert (first.text, answer.text) == ("colour?", '{"name": "green"}')
    assert "name: Input should be 'red' or 'blue'" in complaint.text


def test_objections_of_the_caller_go_back_too() -> None:
    chat = Script('{"name": "red"}', '{"name": "blue"}')
    found = ask(chat, "reasoner", PROMPT, Colour, complaints=lambda a: ["not red, please"] if a.name == "red" else [])
    assert found.name == "blue" and "not red, please" in chat.sent[1][-1].text


def test_three_invalid_answers_are_a_refusal_that_holds_the_last_complaint() -> None:
    with pytest.raises(ModelRefused, match="not JSON"):
        ask(Script("no", "no", "no"), "reasoner", PROMPT, Colour)


def test_the_schema_holds_the_names_and_nothing_that_providers_refuse() -> None:
    assert flat_schema(Colour) == {
        "type": "object",
        "properties": {"name": {"type": "string", "enum": ["red", "blue"]}},
        "required": ["name"],
        "additionalProperties": False,
    }


def test_json_with_braces_inside_strings_is_kept_whole() -> None:
    assert json_of('{"a": "}{"}') == '{"a": "}{"}'


def test_no_name_is_a_word_in_the_schema_and_nothing_in_the_answer() -> None:
    class Place(Answer):
        where: one_or_none(["left", "right"])

    assert flat_schema(Place)["properties"]["where"]["enum"] == ["none", "left", "right"]
    assert ask(Script('{"where": "none"}'), "reasoner", PROMPT, Place).where == ""


MANY = [f"block_{number}" for number in range(200)]


class Many(Answer):
    name: one_of(MANY)
    why: Annotated[str, Field(min_length=1)]


def test_a_long_enumeration_and_bounds_are_not_sent_but_checked_all_the_same() -> None:
    assert flat_schema(Many)["properties"] == {"name": {"type": "string"}, "why": {"type": "string"}}
    chat = Script('{"name": "blok_7", "why": ""}', '{"name": "block_7", "why": "x"}')
    assert ask(chat, "reasoner", PROMPT, Many).name == "block_7"
    complaint = chat.sent[1][-1].text
    assert "'blok_7' is not among the 200 names; near are block_7" in complaint
    assert "why: String should have at least 1 character" in complaint and len(complaint) < 500
