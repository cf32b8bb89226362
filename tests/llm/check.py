"""A real model server answers every prompt under its JSON schema; `make test-llm` starts it and runs this.

The cleverness of answers is not tested with 135 million parameters: an answer has the requested type, a complaint goes
back as another turn, and repeated errors end as a refusal that names them.
"""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from tests.llm.questions import DRAWN, INSTRUCTION, QUESTIONS, RNG
from tests.models.catalogue import unchecked
from tests.run_folders import command
from vcage.base.errors import ConfigurationError, ModelRefused, NoAssetFits, UnreadInstruction
from vcage.models import prompts
from vcage.models.exchange import Answerer, Question, Reply
from vcage.models.llm_reasoner import LlmReasoner
from vcage.models.registry import Choice
from vcage.models.structured import ROUNDS, Answer, ask
from vcage.objects.library import Library

MODEL = "ollama:smollm2:135m"

MOST_TRIES = 8
"""Of an answer that does not come to its end."""


class Witness:
    """Asks another model and records questions and answers; pictures are left out, which the model cannot see."""

    def __init__(self, other: Answerer):
        self.provider, self._other = other.provider, other
        self.seen: list[tuple[Question, Reply]] = []

    def answer(self, question: Question) -> Reply:
        words = replace(question, messages=tuple(replace(m, pictures=()) for m in question.messages))
        for _ in range(MOST_TRIES):
            try:
                self.seen.append((words, reply := self._other.answer(words)))
                return reply
            except ModelRefused as error:
                if error.details.get("finish_reason") != "length":
                    raise
        raise AssertionError(f"{question.name}: {MOST_TRIES} answers did not come to their end")


@pytest.fixture(scope="session")
def url() -> Iterator[str]:
    """A server in a process and an environment of its own."""
    line = [os.environ["VCAGE_LLM_PYTHON"], str(Path(__file__).with_name("server.py"))]
    with subprocess.Popen(line, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdin is not None and server.stdout is not None
        try:
            yield server.stdout.readline().strip()
        finally:
            server.stdin.close()


@pytest.fixture(autouse=True)
def here(url: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    assert url.startswith("http://127.0.0.1:"), url
    monkeypatch.setenv("VCAGE_OLLAMA_URL", url)
    monkeypatch.setenv("VCAGE_KEY_FILE", str(tmp_path / "keys.json"))


@pytest.fixture
def witness() -> Witness:
    who = Choice("ollama").answerer("reasoner")
    assert who is not None and who.provider == MODEL
    return Witness(who)


def test_every_prompt_is_asked() -> None:
    assert set(QUESTIONS) | DRAWN == set(prompts.names())


@pytest.mark.parametrize("name", QUESTIONS)
def test_a_prompt_is_answered_under_its_schema(name: str, witness: Witness) -> None:
    refused = None
    try:
        QUESTIONS[name](witness)
    except (NoAssetFits, UnreadInstruction):
        pass  # an answer, too: it found nothing
    except ModelRefused as error:
        refused = error
    assert {question.name for question, _ in witness.seen} == {name}
    for question, reply in witness.seen:
        Draft202012Validator(question.schema).validate(json.loads(reply.text))
        assert reply.tokens_in and reply.tokens_out
    complained = [question.messages[-1].text for question, _ in witness.seen if question.round > 1]
    assert all(text.startswith("That answer cannot be used") for text in complained)
    if refused is not None:
        assert len(witness.seen) == ROUNDS and all(
            problem in refused.message for problem in refused.details["problems"]
        )


class _Said(Answer):
    word: str


def test_complaints_are_turns_and_the_last_of_them_ends_in_a_refusal_that_names_it(witness: Witness) -> None:
    prompt = prompts.Prompt("word", "Say one word.")
    with pytest.raises(ModelRefused, match="in 3 rounds: word: is not Latin"):
        ask(witness, "reasoner", prompt, _Said, complaints=lambda _: ["word: is not Latin"])
    assert [len(question.messages) for question, _ in witness.seen] == [1, 3, 5]
    tokens = [reply.tokens_in or 0 for _, reply in witness.seen]
    assert tokens[0] < tokens[1] < tokens[2], "the server reads all turns"


def test_a_catalogue_larger_than_the_context_is_an_error_that_names_the_limit(witness: Witness) -> None:
    with pytest.raises(ConfigurationError, match=r"too long for the model.*8192 tokens") as caught:
        LlmReasoner(witness).select_assets(INSTRUCTION, Library.load().entries(), RNG, unchecked)
    assert "longer context" in caught.value.hint


def test_a_critic_is_refused_before_a_picture_is_sent() -> None:
    with pytest.raises(ConfigurationError, match=f"{MODEL} sees no pictures"):
        Choice("offline", critic="ollama").answerer("critic")
    assert Choice("ollama").answerer("critic") is None


def test_the_command_uses_it_without_a_key_and_reports_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in [name for name in os.environ if name.endswith("_API_KEY")]:
        monkeypatch.delenv(name)
    answer = command(capsys, "select-place", INSTRUCTION, "--out", tmp_path / "run")
    assert "models: ollama for reasoner" in answer.stderr and "with smollm2:135m" in answer.stderr
    assert (answer.code, "8192 tokens" in answer.error["message"]) == (4, True)
