"""Sentences of a model that say a task."""

from __future__ import annotations

import json

from tests.models.test_structured import Script
from tests.models.test_wordings import LEFT, ON, task
from vcage.models.llm_reasoner import LlmReasoner

GOOD = "Set the apple down on the plate."
WRONG = "Set the pear down on the plate."


def answer(*sentences: str) -> str:
    return json.dumps({"sentences": [{"sentence": text} for text in sentences]})


def test_sentences_failing_the_review_are_dropped_and_counted():
    chat = Script(answer(GOOD, WRONG, "Eat the apple."))
    assert LlmReasoner(chat).word_task(task(ON), []) == ([GOOD], 2)
    assert len(chat.sent) == 1


def test_where_all_fail_the_complaints_go_back_once():
    chat = Script(answer(WRONG), answer(WRONG, GOOD))
    assert LlmReasoner(chat).word_task(task(ON), []) == ([GOOD], 1)
    assert "is nothing that the task is about" in chat.sent[1][-1].text


def test_if_all_fail_again_there_are_none():
    assert LlmReasoner(Script(answer(WRONG), answer(WRONG))).word_task(task(ON), []) == ([], 1)
    assert LlmReasoner(Script(answer(), answer())).word_task(task(ON), []) == ([], 0)


def test_the_prompt_shows_goals_names_and_the_other_objects():
    chat = Script(answer("Set the apple on the plate and the pear to the left of the plate."))
    LlmReasoner(chat).word_task(task(ON, LEFT), ["Put the apple onto the plate."])
    text = chat.sent[0][0].text
    assert '- step 1: `apple on plate` ("it")' in text
    assert "- `pear`: green pear (also: fruit" in text
    assert "- blue mug" in text.partition("also stands there")[2]
    assert "- Put the apple onto the plate." in text.partition("# Sentences that say it")[2]
