from __future__ import annotations

import pytest

from vcage.schema.goals import goal_of
from vcage.tasks.wording import wordings

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
