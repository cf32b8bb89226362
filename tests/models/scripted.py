"""A model that answers from a script, by the prompt that it is asked."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from vcage.models.exchange import Question, Reply
from vcage.models.structured import NONE

AGREED = {"lacks": [], "adds": []}


class Scripted:
    """Implements :class:`vcage.models.exchange.Answerer`.

    Args:
        answers: what is answered to each prompt, by its name; the last answer again and again. A review agrees.
    """

    provider = "script"

    def __init__(self, **answers: Sequence[Mapping[str, Any]]):
        self._answers = {"review_goals": [AGREED], **{name: list(several) for name, several in answers.items()}}
        self.asked: list[Question] = []

    def answer(self, question: Question) -> Reply:
        self.asked.append(question)
        several = self._answers[question.name]
        return Reply(json.dumps(several.pop(0) if len(several) > 1 else several[0]))

    def names(self) -> list[str]:
        """The prompts that were asked, in order."""
        return [question.name for question in self.asked]

    def complaints(self) -> str:
        """The complaint about the last answer that could not be used."""
        return next(q.messages[-1].text for q in reversed(self.asked) if q.round > 1)


def chosen(look: str, role: str, starts_in: str = NONE, part: str = NONE) -> dict[str, str]:
    """One object of an answer to select_assets."""
    return {"look": look, "role": role, "starts_in": starts_in, "starts_in_part": part, "reason": "it is asked for"}


def selected(*objects: Mapping[str, str]) -> dict[str, Any]:
    """An answer to select_assets."""
    return {"missing": [], "objects": list(objects)}


def goal(subject: str, relation: str, reference: str = NONE, **fields: Any) -> dict[str, Any]:
    """One goal of an answer to read_goals."""
    usual = {"part": NONE, "step": 1, "arm": NONE, "words": ""}
    return {"relation": relation, "subject": subject, "reference": reference} | usual | fields


def description(subject: str, relation: str, reference: str, words: str, part: str = NONE) -> dict[str, str]:
    """One description of an answer to read_goals."""
    return {"subject": subject, "relation": relation, "reference": reference, "part": part, "words": words}


def read(*goals: Mapping[str, Any], **fields: Sequence[Any]) -> dict[str, Any]:
    """An answer to read_goals."""
    usual = {"wrong_objects": [], "unread": [], "descriptions": [], "untouched": []}
    return usual | {"goals": list(goals)} | fields
