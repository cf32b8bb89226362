"""Things that are filled and then moved."""

from __future__ import annotations

import pytest

from tests.example_scenes import thing
from vcage.base.errors import NoFeasibleTask
from vcage.schema.goals import AskedGoal, Goal
from vcage.tasks.filled import require_level

BOWL = [thing("apple"), thing("bowl", (-0.2, 0.0)), thing("tray", (0.2, 0.0))]


def asked(*goals: tuple[str, str, str]) -> list[AskedGoal]:
    """Goals that come one after the other."""
    return [
        AskedGoal(goal=Goal(subject=a, relation=word, reference=b), step=step, words=f"step {step}")
        for step, (a, word, b) in enumerate(goals)
    ]


def test_a_filled_bowl_is_not_carried_and_the_error_says_why_and_what_can_be_asked_for():
    goals = asked(("apple", "inside", "bowl"), ("bowl", "on", "tray"))
    with pytest.raises(NoFeasibleTask, match=r"bowl cannot be carried with the .* apple in it \('step 1'\)") as caught:
        require_level(goals, BOWL)
    assert "move the white bowl first" in caught.value.hint


@pytest.mark.parametrize(
    "goals",
    [
        [("bowl", "on", "tray"), ("apple", "inside", "bowl")],
        [("apple", "inside", "bowl"), ("apple", "on", "tray"), ("bowl", "on", "table")],
    ],
)
def test_a_bowl_that_is_empty_when_it_is_moved_is_not_refused(goals: list[tuple[str, str, str]]):
    require_level(asked(*goals), BOWL)


def test_a_cup_which_is_held_by_its_middle_is_carried_with_its_contents():
    objects = [thing("lipstick"), thing("cup", (-0.2, 0.0)), thing("plate", (0.2, 0.0))]
    require_level(asked(("lipstick", "inside", "cup"), ("cup", "on", "plate")), objects)
