"""What a model with eyes is told of a sub-task."""

from __future__ import annotations

from typing import get_args

import pytest

from tests.models.tabletop import BOX, MARKERS, critic_question
from vcage.models.exchange import Question, Reply
from vcage.models.llm_critic import Judgement, LlmCritic, _in_words, _verdict
from vcage.models.structured import flat_schema
from vcage.schema.episodes import Failure, Verdict
from vcage.schema.goals import Goal

PHRASES = {"box": "red box", "cabinet": "white cabinet"}


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        (Goal(subject="box", relation="left_of", reference="cabinet"), "the red box is left of the white cabinet"),
        (Goal(subject="box", relation="on", reference="table"), "the red box is on the table"),
        (Goal(subject="box", relation="scanned"), "the red box is scanned"),
        (Goal(subject="box", relation="handed", reference="right"), "the red box is handed to the right arm"),
        (Goal(subject="cabinet", relation="open", part="drawer_top"), "the top drawer of the white cabinet is open"),
        (
            Goal(subject="box", relation="inside", reference="cabinet", part="drawer_top"),
            "the red box is inside the top drawer of the white cabinet",
        ),
    ],
)
def test_a_goal_is_told_in_words(goal: Goal, words: str) -> None:
    assert _in_words(goal, PHRASES) == words


def test_the_answer_may_name_every_failure_that_a_retry_heeds() -> None:
    allowed = flat_schema(Judgement)["properties"]["failure"]["enum"]
    assert set(allowed) == {"none", "other", *get_args(Failure)}


@pytest.mark.parametrize(
    ("accepted", "failure", "told"),
    [(False, "astray", "astray"), (False, "other", None), (False, "none", None), (True, "lost", None)],
)
def test_only_a_no_tells_what_went_wrong(accepted: bool, failure: str, told: Failure | None) -> None:
    verdict = _verdict([judgement("yes" if accepted else "no", failure)], "test")
    assert verdict == Verdict(accepted=accepted, reason="seen", confidence=0.9, provider="test", failure=told)


def judgement(done: str, failure: str = "none") -> Judgement:
    said = {"observations": "", "done": done, "failure": failure, "reason": "seen", "confidence": 0.9}
    return Judgement.model_validate(said)


def test_unsure_is_a_no_and_says_so():
    verdict = _verdict([judgement("unsure")], "test")
    assert (verdict.accepted, verdict.reason) == (False, "unsure, which is a no: seen")


class Votes:
    """Gives each vote its own answer."""

    provider = "test"

    def __init__(self, *said: str):
        self.said = said
        self.asked: list[Question] = []

    def answer(self, question: Question) -> Reply:
        self.asked.append(question)
        return Reply(judgement(self.said[question.vote - 1]).model_dump_json())


@pytest.mark.parametrize(
    ("said", "accepted", "asked"),
    [
        (("yes", "yes", "no"), True, 2),
        (("no", "yes", "yes"), True, 3),
        (("yes", "unsure", "no"), False, 3),
        (("no", "unsure", "yes"), False, 2),
        (("yes", "no"), False, 2),
        (("yes", "yes", "no", "no"), False, 4),
    ],
)
def test_more_than_half_of_the_votes_must_be_a_yes_and_no_more_are_asked_than_decide(said, accepted, asked):
    who = Votes(*said)
    things, goal = [BOX, MARKERS[0]], Goal(subject="black-marker", relation="inside", reference="box")
    verdict = LlmCritic(who, len(said)).judge(critic_question(things, things, goal))
    assert verdict.accepted is accepted
    assert len({question.hash for question in who.asked}) == len(who.asked) == asked
    assert f"of {asked} votes" in verdict.reason and verdict.provider == f"test, {len(said)} votes"
