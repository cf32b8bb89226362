"""The question to a model for further sentences that say a task, each of which is reviewed in code."""

from __future__ import annotations

from collections.abc import Sequence

from vcage.base.text import one_line
from vcage.models import prompts
from vcage.models.structured import Answer, Asking
from vcage.models.wordings import TaskToWord, TaskWordings

EXAMPLES = 3
"""Sentences of templates that the prompt shows."""


class _Sentence(Answer):
    sentence: str


class _WordingsAnswer(Answer):
    sentences: list[_Sentence]


def ask_wordings(put: Asking, task: TaskToWord, plain: Sequence[str]) -> TaskWordings:
    """Ask once for sentences; once more, with what is wrong with them, where none holds against the review.

    Args:
        put: asks.
        task: what a sentence must ask for, and may name.
        plain: sentences of templates, as examples.

    Raises:
        ModelRefused, AnswerNeeded, EndpointFailed, ConfigurationError: see :func:`vcage.models.structured.ask`.
    """
    complained = False

    def complaints(answer: _WordingsAnswer) -> list[str]:
        nonlocal complained
        if complained or task.reviewed(_texts(answer)):
            return []
        complained = True
        wrong = [f"{text!r}: {'; '.join(task.complaints(text))}" for text in _texts(answer)]
        return wrong or ["sentences: is empty"]

    prompt = prompts.fill("word_task", task=task, plain=list(plain[:EXAMPLES]))
    proposed = _texts(put(prompt, _WordingsAnswer, complaints))
    sentences = task.reviewed(proposed)
    return TaskWordings(sentences, len(proposed) - len(sentences))


def _texts(answer: _WordingsAnswer) -> list[str]:
    return list(dict.fromkeys(one_line(item.sentence).strip() for item in answer.sentences))
