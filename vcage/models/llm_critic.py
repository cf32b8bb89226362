"""The critic behind any answerer with vision."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import partial
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from vcage.goals import meanings
from vcage.goals.thresholds import THRESHOLDS
from vcage.models import prompts
from vcage.models.exchange import Answerer
from vcage.models.protocols import CriticQuestion
from vcage.models.structured import Answer, ask, narrowed, one_of
from vcage.plans.plain_words import goal_in_words
from vcage.schema.episodes import Failure, Verdict
from vcage.schema.subtasks import Statement
from vcage.vision.protocols import Reference


class Judgement(Answer):
    """The model's answer: what it sees first, then the verdict on the step, and other moved objects.

    The step may be done and another object moved: then the verdict is a no all the same.
    """

    observations: str
    done: Literal["yes", "no", "unsure"]
    failure: Literal["none", "lost", "astray", "other"]
    also_moved: list[str]
    reason: Annotated[str, Field(min_length=1)]
    confidence: float


class LlmCritic:
    """Implements :class:`vcage.models.protocols.Critic`: the paper's φ(I, T), with pictures before and after.

    Args:
        who: the model to ask.
        votes: number of questions; more than half of the answers must be a yes, and an unsure answer is none.
    """

    def __init__(self, who: Answerer, votes: int = 1):
        self._who, self._votes = who, votes
        self.provider = who.provider if votes == 1 else f"{who.provider}, {votes} votes"

    def judge(self, question: CriticQuestion) -> Verdict:
        """The model's verdict.

        Raises:
            ModelRefused, AnswerNeeded, EndpointFailed, ConfigurationError: see :func:`vcage.models.structured.ask`.
        """
        phrases = {object_id: reference.phrase for object_id, reference in question.references.items()}
        pictures = _pictures(question)
        prompt = prompts.fill(
            "judge_subtask",
            text=question.text,
            truths=[goal_in_words(goal, phrases) for goal in question.goals],
            meanings=meanings(question.goals, THRESHOLDS),
            limits=THRESHOLDS,
            phrases=phrases,
            pictures=[name for name, _ in pictures],
            statements=[_still(statement, phrases) for statement in question.statements],
        )
        answer = narrowed(Judgement, also_moved=list[one_of(list(phrases))])  # pyrefly: ignore
        handled = {goal.subject for goal in question.goals} | {question.grasped}
        votes: list[Judgement] = []
        while not _decided(votes, self._votes):
            asking = {"pictures": pictures, "complaints": partial(_complaints, handled), "vote": len(votes) + 1}
            votes.append(ask(self._who, "critic", prompt, answer, **asking))
        return _verdict(votes, self.provider, phrases)


def _pictures(question: CriticQuestion) -> list[tuple[str, np.ndarray]]:
    """All pictures in the order of the prompt, and last the references of the goals' objects."""
    found: list[tuple[str, np.ndarray]] = []
    for when in ("start", "before", "moment", "later", "after"):
        calibrated = {name: view.picture for name, view in getattr(question, when).items()}
        for by_camera in (calibrated, question.uncalibrated.get(when, {})):
            found += [(f"{when}, camera {name}", by_camera[name]) for name in sorted(by_camera)]
    concerned = dict.fromkeys(name for goal in question.goals for name in (goal.subject, goal.reference))
    looks = [question.references[name] for name in concerned if name in question.references]
    return found + [(f"the {look.phrase} alone, from above", _on_white(look)) for look in looks]


def _is_yes(judgement: Judgement) -> bool:
    """True where the step was done and nothing else was moved."""
    return judgement.done == "yes" and not judgement.also_moved


def _decided(said: Sequence[Judgement], votes: int) -> bool:
    """True if the remaining votes cannot change the result."""
    yes = sum(map(_is_yes, said))
    return 2 * yes > votes or 2 * (yes + votes - len(said)) <= votes


def _verdict(said: Sequence[Judgement], provider: str, phrases: Mapping[str, str]) -> Verdict:
    """The verdict of the votes, in the words of the first one on the side that won."""
    yes = [judgement for judgement in said if _is_yes(judgement)]
    accepted = 2 * len(yes) > len(said)
    won = yes if accepted else [judgement for judgement in said if not _is_yes(judgement)]
    counted = f"{len(yes)} of {len(said)} votes are a yes: " if len(said) > 1 else ""
    unsure = "unsure, which is a no: " if won[0].done == "unsure" else ""
    moved = " and ".join(f"the {phrases.get(name, name)}" for name in won[0].also_moved)
    failures = [] if accepted else [failure for judgement in won if (failure := _failure(judgement)) is not None]
    return Verdict(
        accepted=accepted,
        reason=f"{counted}{unsure}{won[0].reason}{f' (also moved: {moved})' if moved else ''}",
        confidence=sum(judgement.confidence for judgement in won) / len(said),
        provider=provider,
        failure=next(iter(failures), None),
    )


def _failure(judgement: Judgement) -> Failure | None:
    """The failure given by a vote that is not a yes; None without one."""
    if judgement.done != "yes" and judgement.failure not in ("none", "other"):
        return judgement.failure
    return "disturbed" if judgement.also_moved else None


def _still(statement: Statement, phrases: Mapping[str, str]) -> str:
    """A statement in words, with the objects' phrases."""
    if statement.goal is None:
        return f"the {phrases.get(statement.subject, statement.subject)} has not moved"
    return goal_in_words(statement.goal, phrases).replace(" is ", " is still ", 1)


def _on_white(look: Reference) -> np.ndarray:
    """(h, w, 3) uint8."""
    return np.where(look.picture[..., 3:] > 127, look.picture[..., :3], np.uint8(255))


def _complaints(handled: Collection[str | None], answer: Judgement) -> list[str]:
    """Complaints about an answer.

    Args:
        handled: ids of objects of the step, which cannot be moved besides.
    """
    found = [] if 0 <= answer.confidence <= 1 else [f"confidence: {answer.confidence} is not between 0 and 1"]
    if answer.done == "yes" and answer.failure != "none":
        found.append(f"failure: {answer.failure!r} belongs to a no, and done says yes")
    return found + [f"also_moved: {name} is what the step moves" for name in answer.also_moved if name in handled]
