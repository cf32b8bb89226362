"""Commands of sub-tasks as memories."""

from __future__ import annotations

import pytest

from vcage.datasets.lerobot.memory import in_past, memory_of
from vcage.goals import KINDS

PAST_VERBS = {
    "put", "handed", "showed", "opened", "closed", "pressed", "turned", "scanned", "weighed", "pushed", "held", "moved",
    "lifted", "shook", "hit", "wiped", "poured", "hung", "stood", "inserted",
}  # fmt: skip
"""Of all sub-tasks that the library makes."""


@pytest.mark.parametrize(
    ("command", "past"),
    [
        ("Put the pen into the box.", "put the pen into the box"),
        ("Carry it away.", "carried it away"),
        ("Close the lid!", "closed the lid"),
        ("Grab it.", "grabbed it"),
        ("Scan", "scanned"),
        ("Hand the mug to the left arm, which puts it down.", "handed the mug to the left arm, which put it down"),
    ],
)
def test_a_command_is_told_in_the_past(command, past):
    assert in_past(command) == past


def test_three_finished_sub_tasks_make_one_sentence():
    assert memory_of(["Open it.", "Take it.", "Close it."]) == "I opened it, took it and closed it."


@pytest.mark.parametrize("kind", [kind for kind in KINDS.values() if kind.commands], ids=lambda kind: kind.word)
def test_the_sub_tasks_of_every_kind_of_goal_have_a_past(kind):
    plainest = kind.commands.split("|")[0].format("the mug", "The mug", "left", tool="the hammer")
    assert in_past(plainest).split()[0] in PAST_VERBS
