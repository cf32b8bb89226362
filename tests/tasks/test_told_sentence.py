"""The plain sentence of goals: true, complete, and clear about which object is meant."""

from __future__ import annotations

import pytest

from vcage.base.errors import UsageError
from vcage.schema.goals import AskedGoal, Description, goal_of
from vcage.tasks.told_sentence import Called, Sentence, sentence_of

CALLED = {
    "apple": Called("apple", "apples"),
    "lemon": Called("lemon", "lemons"),
    "block": Called("red block", "red blocks"),
    "block_2": Called("red block", "red blocks"),
    "bowl": Called("white bowl", "white bowls"),
    "plate": Called("white plate", "white plates"),
    "plate_2": Called("white plate", "white plates"),
    "cabinet": Called("cabinet", "cabinets"),
}


def asked(*words: str, step: int = 1, arm: str | None = None) -> AskedGoal:
    return AskedGoal(goal=goal_of(words), step=step, words="?", arm=arm)


def start(subject: str, relation: str, reference: str, part: str | None = None) -> Description:
    place = {"subject": subject, "relation": relation, "reference": reference, "part": part}
    return Description.model_validate({**place, "words": "?"})


def say(*goals: AskedGoal, starts: tuple[Description, ...] = ()) -> Sentence:
    return sentence_of(goals, starts, CALLED)


def test_steps_follow_each_other_with_then():
    lid = AskedGoal(goal=goal_of(["cabinet", "closed", None, "drawer_top"]), step=2, words="?")
    said = say(asked("apple", "inside", "cabinet", "drawer_top"), lid)
    assert said.text == "Put the apple into the top drawer of the cabinet, then close the top drawer of the cabinet."


def test_things_with_one_place_share_a_clause_and_keep_their_order():
    said = say(asked("apple", "inside", "bowl"), asked("cabinet", "back"), asked("lemon", "inside", "bowl"))
    assert said.text == "Put the apple and the lemon into the white bowl and put the cabinet back."
    assert [one.goal.subject for one in said.goals] == ["apple", "cabinet", "lemon"]
    assert said.goals[0].words == said.goals[2].words == "Put the apple and the lemon into the white bowl"


def test_another_arm_is_another_clause():
    said = say(asked("apple", "inside", "bowl", arm="left"), asked("lemon", "inside", "bowl", arm="right"))
    assert said.text == (
        "Put the apple into the white bowl with the left arm and put the lemon into the white bowl with the right arm."
    )


def test_all_that_are_called_the_same_are_counted():
    assert say(asked("block", "inside", "bowl"), asked("block_2", "inside", "bowl")).text == (
        "Put the two red blocks into the white bowl."
    )


def test_one_of_two_that_are_called_the_same_is_refused_without_a_start_that_tells():
    with pytest.raises(UsageError, match="block and block_2 are all called 'red block'") as caught:
        say(asked("block", "inside", "bowl"))
    assert "--start 'block left_of block_2'" in caught.value.hint


def test_a_start_tells_which_one_is_meant_and_the_other_is_the_other():
    left = start("plate", "left_of", "plate_2")
    said = say(asked("apple", "on", "plate"), asked("lemon", "on", "plate_2", step=2), starts=(left,))
    assert said.text == (
        "Put the apple onto the white plate that is to the left of the other white plate, "
        "then put the lemon onto the other white plate."
    )
    assert [one.words for one in said.descriptions] == ["to the left of the other white plate"]


def test_two_with_the_same_start_are_refused():
    with pytest.raises(UsageError, match="are all called 'red block'"):
        say(asked("block", "inside", "bowl"), starts=(start("block", "on", "plate"), start("block_2", "on", "plate")))


def test_where_a_thing_is_taken_from_is_said_when_it_is_first_mentioned():
    said = say(
        asked("lemon", "on", "table"),
        asked("lemon", "inside", "bowl", step=2),
        starts=(start("lemon", "inside", "cabinet", "drawer_top"),),
    )
    assert said.text == (
        "Put the lemon that is in the top drawer of the cabinet onto the table, then put the lemon into the white bowl."
    )


def test_a_start_of_what_no_goal_names_leaves_the_sentence_alone():
    said = say(asked("apple", "inside", "bowl"), starts=(start("lemon", "center", "table"),))
    assert said.text == "Put the apple into the white bowl."
    assert said.descriptions[0].words == said.text


def test_handing_over_stays_one_clause():
    assert "," not in say(asked("apple", "handed", "left")).text
