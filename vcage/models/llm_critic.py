"""The critic behind whatever answers questions and sees pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from vcage.models import prompts
from vcage.models.exchange import Answerer
from vcage.models.protocols import CriticQuestion
from vcage.models.structured import Answer, ask
from vcage.schema.episodes import Verdict
from vcage.schema.goals import OF_A_PART, Goal, part_words
from vcage.vision.protocols import Reference


class Judgement(Answer):
    """What the model answers: what it sees first, then the verdict."""

    observations: str
    done: Literal["yes", "no", "unsure"]
    failure: Literal["none", "lost", "astray", "disturbed", "other"]
    reason: Annotated[str, Field(min_length=1)]
    confidence: float


class LlmCritic:
    """Implements :class:`vcage.models.protocols.Critic`: the paper's φ(I, T), with pictures before and after.

    Args:
        who: is asked.
        votes: how often; more than half of the answers must be a yes, and what is unsure is none.
    """

    def __init__(self, who: Answerer, votes: int = 1):
        self._who, self._votes = who, votes
        self.provider = who.provider if votes == 1 else f"{who.provider}, {votes} votes"

    def judge(self, question: CriticQuestion) -> Verdict:
        """The model's verdict.

        Raises:
            ModelRefused, AnswerNeeded, EndpointFailed, ConfigurationError: see :func:`vcage.models.structured.ask`.
        """
        named = []
        for when in ("start", "before", "moment", "after"):
            shown = {name: view.picture for name, view in getattr(question, when).items()}
            for by_camera in (shown, question.wrist.get(when, {})):
                named += [(f"{when}, camera {name}", by_camera[name]) for name in sorted(by_camera)]
        concerned = dict.fromkeys(name for goal in question.goals for name in (goal.subject, goal.reference))
        shown = [question.references[name] for name in concerned if name in question.references]
        named += [(f"the {look.phrase} alone, from above", _on_white(look)) for look in shown]
        phrases = {object_id: reference.phrase for object_id, reference in question.references.items()}
        prompt = prompts.fill(
            "judge_subtask",
            text=question.text,
            truths=[_in_words(goal, phrases) for goal in question.goals],
            phrases=phrases,
            pictures=[name for name, _ in named],
        )
        said: list[Judgement] = []
        while not _decided(said, self._votes):
            vote = {"pictures": named, "complaints": _complaints, "vote": len(said) + 1}
            said.append(ask(self._who, "critic", prompt, Judgement, **vote))
        return _verdict(said, self.provider)


def _decided(said: Sequence[Judgement], votes: int) -> bool:
    """Whether the votes that are left could change nothing."""
    yes = sum(judgement.done == "yes" for judgement in said)
    return 2 * yes > votes or 2 * (yes + votes - len(said)) <= votes


def _verdict(said: Sequence[Judgement], provider: str) -> Verdict:
    """What the votes come to, in the words of the first one on the side that won."""
    yes = [judgement for judgement in said if judgement.done == "yes"]
    accepted = 2 * len(yes) > len(said)
    won = yes if accepted else [judgement for judgement in said if judgement.done != "yes"]
    told = f"{len(yes)} of {len(said)} votes are a yes: " if len(said) > 1 else ""
    unsure = "unsure, which is a no: " if won[0].done == "unsure" else ""
    failures = [] if accepted else [judgement.failure for judgement in won]
    return Verdict(
        accepted=accepted,
        reason=f"{told}{unsure}{won[0].reason}",
        confidence=sum(judgement.confidence for judgement in won) / len(said),
        provider=provider,
        failure=next((failure for failure in failures if failure not in ("none", "other")), None),
    )


def _in_words(goal: Goal, phrases: Mapping[str, str]) -> str:
    """What a goal says, with the objects' phrases."""
    thing, word = phrases.get(goal.subject, goal.subject), goal.relation.replace("_", " ")
    if goal.relation in OF_A_PART:
        return f"the {part_words(str(goal.part))} of the {thing} is {word}"
    if goal.relation == "handed":
        return f"the {thing} is handed to the {goal.reference} arm"
    if goal.relation == "back":
        return f"the {thing} is back where it stood at the start"
    if goal.relation == "presented":
        return f"the {thing} stands on the customer's half of the table with its front towards the customer"
    if goal.reference is None:
        return f"the {thing} is {word}"
    place = f"the {phrases.get(goal.reference, goal.reference)}"
    return f"the {thing} is {word} {place if goal.part is None else f'the {part_words(goal.part)} of {place}'}"


def _on_white(look: Reference) -> np.ndarray:
    """(h, w, 3) uint8."""
    return np.where(look.picture[..., 3:] > 127, look.picture[..., :3], np.uint8(255))


def _complaints(answer: Judgement) -> list[str]:
    found = [] if 0 <= answer.confidence <= 1 else [f"confidence: {answer.confidence} is not between 0 and 1"]
    if answer.done == "yes" and answer.failure != "none":
        found.append(f"failure: {answer.failure!r} belongs to a no, and done says yes")
    return found
