"""A reading in plain words."""

from __future__ import annotations

from vcage.plans.plain_words import reading_in_words
from vcage.schema.goals import AskedGoal, Description, Reading, goal_of

PHRASES = {"mug": "red mug", "plate": "white plate", "cabinet": "oak cabinet", "bowl": "green bowl"}


def test_start_order_arm_and_objects_left_alone_are_stated() -> None:
    first = AskedGoal(goal=goal_of(["mug", "on", "plate"]), step=1, words="words", arm="left")
    then = AskedGoal(goal=goal_of(["cabinet", "closed", None, "drawer_top"]), step=2, words="words")
    told = [
        Description(subject="mug", relation="inside", reference="cabinet", part="drawer_top", words="words"),
        Description(subject="plate", relation="left_of", reference="table", words="words"),
    ]
    assert reading_in_words(Reading(goals=[first, then], descriptions=told, untouched=["bowl"]), PHRASES) == [
        "At the start the red mug is inside the top drawer of the oak cabinet.",
        "At the start the white plate is on the left of the table.",
        "Step 1: the red mug is on the white plate, by the left arm.",
        "Step 2: the top drawer of the oak cabinet is closed.",
        "The green bowl is left alone.",
    ]
