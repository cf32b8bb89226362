"""Asking a model what an instruction asks for.

Three checks follow an answer: by code, by a reader without a model where it reads the sentence, and by a question more.
"""

from __future__ import annotations

from vcage.base.errors import UnreadInstruction
from vcage.goals import forms
from vcage.models import prompts
from vcage.models.goal_answers import GoalsAnswer, Instructed, answer_type, misshapen, reading_of
from vcage.models.same_reading import ThirdReader, contradictions
from vcage.models.structured import Answer, Asking
from vcage.plans.consistency import inconsistencies
from vcage.plans.plain_words import reading_in_words
from vcage.schema.goals import Reading


class _ReviewAnswer(Answer):
    lacks: list[str]
    adds: list[str]


def read_goals(ask: Asking, read: Instructed, reviewer: Asking | None, third: ThirdReader | None) -> Reading:
    """The model's reading, once no check complains about it.

    Args:
        ask: puts a prompt to the model.
        read: what is read.
        reviewer: puts the review to a model; None for no review.
        third: a reader without a model; None for none.

    Raises:
        UnreadInstruction: words of it answer to no goal; or other objects are needed, and
            ``details["wrong_objects"]`` says why.
        ModelRefused: see :func:`vcage.models.structured.ask`.
    """
    prompt = prompts.fill(
        "read_goals",
        instruction=read.instruction,
        things=dict(read.things),
        lying=dict(read.lying),
        contents=list(read.moved),
        forms=forms(),
    )
    found = ask(prompt, answer_type(read), lambda a: _complaints(a, read, reviewer, third))
    if found.unread or found.wrong_objects:
        said = "; ".join([*found.unread, *found.wrong_objects])
        why = "no goal answers it" if found.unread else "the objects that were chosen do not allow it"
        error = UnreadInstruction.of(read.instruction, said, why)
        error.details["wrong_objects"] = [] if found.unread else list(found.wrong_objects)
        raise error
    return reading_of(found)


def _complaints(answer: GoalsAnswer, read: Instructed, reviewer: Asking | None, third: ThirdReader | None) -> list[str]:
    """The complaints of the first check that has any: later ones cost more."""
    if answer.unread or answer.wrong_objects:
        return ["goals: is not empty, although unread or wrong_objects is not"] if answer.goals else []
    found = misshapen(answer, read)
    if found:
        return found
    reading = reading_of(answer)
    return (
        inconsistencies(reading.goals, reading.descriptions)
        or contradictions(read.instruction, read.things, reading, read.moved, read.lying, third)
        or _review(reading, read, reviewer)
    )


def _review(reading: Reading, read: Instructed, reviewer: Asking | None) -> list[str]:
    """Things that the goals lack or add, as a model says that looks at them in plain words."""
    if reviewer is None:
        return []
    phrases = read.phrases
    prompt = prompts.fill(
        "review_goals",
        instruction=read.instruction,
        phrases=phrases,
        lying={name: read.lying.get(name, "") for name in phrases},
        sentences=reading_in_words(reading, phrases),
    )
    found = reviewer(prompt, _ReviewAnswer, lambda _: [])
    lacks = [f"a review says that the goals lack this: {text}" for text in found.lacks if text.strip()]
    return lacks + [f"a review says that the goals add this: {text}" for text in found.adds if text.strip()]
