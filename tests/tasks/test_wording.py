from __future__ import annotations

import pytest

from vcage.schema.goals import goal_of
from vcage.tasks.wording import by_arm, in_one_sentence, wordings

PHRASES = {"pen": "red pen", "cabinet": "white cabinet", "bell": "service bell"}


@pytest.mark.parametrize(
    ("goal", "first"),
    [
        (("pen", "inside", "cabinet", "drawer_top"), "Put the red pen into the top drawer of the white cabinet."),
        (("pen", "on", "cabinet", None), "Put the red pen onto the white cabinet."),
        (("cabinet", "open", None, "drawer_top"), "Open the top drawer of the white cabinet."),
        (("cabinet", "closed", None, "drawer_top"), "Close the top drawer of the white cabinet."),
        (("bell", "pressed", None, "button"), "Press the button of the service bell."),
        (("bell", "turned", None, "dial"), "Turn the dial of the service bell."),
        (("pen", "handed", "right"), "Hand the red pen to the right arm, which puts it down."),
    ],
)
def test_a_goal_is_asked_for_in_ten_different_ways_and_more(goal: tuple[str | None, ...], first: str) -> None:
    found = wordings(goal_of(goal), PHRASES)
    assert found[0] == first
    assert len(set(found)) == len(found) >= 10
    assert all(PHRASES[goal[0] or ""] in sentence and sentence[-1] in ".?" for sentence in found)


OPEN = ["Open the drawer.", "Please open the drawer.", "Pull the drawer open.", "The drawer should be open."]
PUT = ["Put the red cup into the drawer.", "Place the red cup in the drawer."]
WEIGH = ["Weigh the apple."]


def test_one_command_is_said_in_its_own_wordings():
    assert in_one_sentence([[OPEN]]) == OPEN


def test_steps_are_said_in_their_order_with_then():
    found = in_one_sentence([[OPEN], [PUT]])
    assert found[0] == "Open the drawer, then put the red cup into the drawer."
    assert "Pull the drawer open, then place the red cup in the drawer." in found


def test_what_may_come_in_any_order_is_joined_by_and():
    assert in_one_sentence([[PUT, WEIGH]])[0] == "Put the red cup into the drawer and weigh the apple."


def test_wishes_and_statements_are_not_strung_together():
    assert not any("please" in text.lower() or "should" in text for text in in_one_sentence([[OPEN], [PUT]]))


def test_a_command_names_the_arm_that_must_do_it():
    assert by_arm(PUT[:1], "left") == [
        "Put the red cup into the drawer with the left arm.",
        "Use the left arm to put the red cup into the drawer.",
    ]
