"""Two readings of one instruction, up to objects that look alike."""

from __future__ import annotations

from tests.models.catalogue import CATALOGUE
from vcage.models.same_reading import differences
from vcage.schema.goals import AskedGoal, Description, Reading, goal_of

BLOCK, PLATE = (next(kind for kind in CATALOGUE if kind.name == name) for name in ("block", "plate"))
RED, BLUE = (BLOCK.model_copy(update={"variants": [v for v in BLOCK.variants if v.id == c]}) for c in ("red", "blue"))
THINGS = {"block_red": RED, "block_red_2": RED, "block_blue": BLUE, "plate": PLATE}


def reading(
    *goals: tuple[str, str, str], steps: tuple[int, ...] = (), told: tuple[str, str, str] | None = None
) -> Reading:
    asked = [
        AskedGoal(goal=goal_of(list(goal)), step=step, words="words")
        for goal, step in zip(goals, steps or (1,) * len(goals), strict=True)
    ]
    descriptions = [Description(subject=told[0], relation=told[1], reference=told[2], words="words")] if told else []
    return Reading(goals=asked, descriptions=descriptions)


def test_objects_that_look_alike_may_stand_for_each_other() -> None:
    assert differences(reading(("block_red", "on", "plate")), reading(("block_red_2", "on", "plate")), THINGS) == (
        [],
        [],
    )


def test_an_object_of_another_look_does_not() -> None:
    found = differences(reading(("block_red", "on", "plate")), reading(("block_blue", "on", "plate")), THINGS)
    assert found == (["block_blue on plate"], ["block_red on plate"])


def test_left_of_is_right_of_the_other_way_round() -> None:
    one, other = reading(("block_red", "left_of", "plate")), reading(("plate", "right_of", "block_red"))
    assert differences(one, other, THINGS) == ([], [])


def test_a_lost_order_is_a_difference() -> None:
    goals = (("block_red", "on", "plate"), ("block_blue", "on", "plate"))
    missing, _ = differences(reading(*goals), reading(*goals, steps=(1, 2)), THINGS)
    assert missing == ["block_red on plate before block_blue on plate"]
    assert differences(reading(*goals, steps=(1, 2)), reading(*goals), THINGS) == ([], [])


def test_a_description_missing_on_one_side_is_a_difference() -> None:
    plain = reading(("block_red", "on", "plate"))
    described = reading(("block_red", "on", "plate"), told=("block_red", "left_of", "plate"))
    assert differences(plain, described, THINGS) == (["block_red left_of plate at the start"], [])
    assert differences(described, plain, THINGS) == ([], ["block_red left_of plate at the start"])
