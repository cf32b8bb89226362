"""What a model with eyes is told of a sub-task."""

from __future__ import annotations

from typing import get_args

import pytest

from vcage.models.llm_critic import Judgement, _in_words, _verdict
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
    answer = {"observations": "", "accepted": accepted, "failure": failure, "reason": "seen", "confidence": 0.9}
    verdict = _verdict(Judgement.model_validate(answer), "test")
    assert verdict == Verdict(accepted=accepted, reason="seen", confidence=0.9, provider="test", failure=told)
