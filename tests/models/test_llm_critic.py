"""What a model with eyes is told of a sub-task."""

from __future__ import annotations

import pytest

from vcage.models.llm_critic import _in_words
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
