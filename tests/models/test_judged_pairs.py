"""Questions to a model about pairs of an object and a receptacle."""

from __future__ import annotations

import json

from vcage.models.exchange import Question, Reply
from vcage.models.llm_reasoner import LlmReasoner
from vcage.schema.subtasks import PairQuestion


class Judges:
    """Finds every pair sensible whose line names a tray, with the line's number as its reason."""

    provider = "test"

    def __init__(self) -> None:
        self.prompts: list[str] = []

    def answer(self, question: Question) -> Reply:
        self.prompts.append(question.messages[0].text)
        lines = [line for line in self.prompts[-1].splitlines() if ". Put the " in line]
        pairs = [{"number": n, "sensible": "tray" in line, "reason": line} for n, line in enumerate(lines, start=1)]
        return Reply(json.dumps({"pairs": pairs}))


def pair(thing: str, words: str, receptacle: str = "tray", width: float = 0.2) -> PairQuestion:
    sizes = {"object_size": (0.04, 0.04, 0.04), "opening_size": (width, 0.2, 0.01)}
    return PairQuestion(
        object=thing, object_words=words, receptacle=receptacle, receptacle_words=receptacle, holds="on", **sizes
    )


def test_pairs_that_look_the_same_are_asked_about_once_and_all_answered() -> None:
    who = Judges()
    questions = [pair("a", "red block"), pair("b", "red block"), pair("c", "blue block"), pair("a", "red block", "mug")]
    answers = LlmReasoner(who).judge_pairs(questions)
    assert [(a.object, a.receptacle, a.sensible) for a in answers] == [
        ("a", "tray", True),
        ("b", "tray", True),
        ("c", "tray", True),
        ("a", "mug", False),
    ]
    (prompt,) = who.prompts
    assert prompt.count("Put the ") == 3 and answers[0].reason == answers[1].reason != answers[2].reason


def test_pairs_of_other_sizes_are_not_the_same() -> None:
    who = Judges()
    LlmReasoner(who).judge_pairs([pair("a", "red block"), pair("b", "red block", width=0.1)])
    assert who.prompts[0].count("Put the ") == 2


def test_many_pairs_are_asked_about_in_batches_and_answered_in_order() -> None:
    who = Judges()
    questions = [pair(f"b{n}", f"block number {n}") for n in range(32)]
    answers = LlmReasoner(who).judge_pairs([*questions, questions[0]])
    assert [prompt.count("Put the ") for prompt in who.prompts] == [30, 2]
    assert [a.object for a in answers] == [*(q.object for q in questions), "b0"]
    assert all(f"number {n} " in answer.reason for n, answer in enumerate(answers[:-1]))


def test_an_existing_instruction_is_shown() -> None:
    who = Judges()
    LlmReasoner(who).judge_pairs([pair("a", "red block")], "Set the table for two")
    LlmReasoner(who).judge_pairs([pair("a", "red block")])
    assert "Set the table for two" in who.prompts[0]
    assert "task" not in who.prompts[1]
