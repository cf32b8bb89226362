"""The grammar of goals given by the user: accepted forms, and errors that name the rest."""

from __future__ import annotations

import pytest

from vcage.base.errors import UnknownName, UsageError
from vcage.scenes.stated_goals import StatedGoal, StatedTask


def said(*goals: str, starts: tuple[str, ...] = (), objects: str | None = None) -> StatedTask:
    told = StatedTask.of(goals, starts, objects)
    assert told is not None
    return told


def test_no_given_goal_makes_no_stated_task():
    assert StatedTask.of((), (), None) is None


@pytest.mark.parametrize(
    "text, subject, word, reference",
    [
        ("marker/red inside packaging_box", "marker/red", "inside", "packaging_box"),
        ("marker inside cabinet/oak/drawer_top", "marker", "inside", "cabinet/oak/drawer_top"),
        ("apple on table", "apple", "on", "table"),
        ("lidded_box/lid closed", "lidded_box/lid", "closed", None),
        ("chocolate_bar scanned", "chocolate_bar", "scanned", None),
        ("hammer handed left", "hammer", "handed", "left"),
    ],
)
def test_each_form_is_taken_apart(text: str, subject: str, word: str, reference: str | None):
    assert said(text).goals == (StatedGoal(text, subject, word, reference),)


def test_then_begins_a_step_and_the_arm_is_no_part_of_the_goal():
    first, second, third = said("a inside b", "c inside b  with the left arm", "then b/lid closed").goals
    assert [one.step for one in (first, second, third)] == [1, 1, 2]
    assert (second.reference, second.arm) == ("b", "left")


def test_objects_have_counts():
    assert said("a back", objects=" marker/red, packaging_box,2 apple").objects == (
        (1, "marker/red"),
        (1, "packaging_box"),
        (2, "apple"),
    )


@pytest.mark.parametrize(
    "goals, starts, objects, complaint",
    [
        (["then a inside b"], [], None, "the first goal, 'then a inside b', has none before it"),
        ([""], [], None, "'' is no goal"),
        (["marker"], [], None, "'marker' is no goal"),
        (["put the marker into the box"], [], None, "'put the marker into the box' is no goal"),
        (["Marker inside box"], [], None, "'Marker' is no name"),
        (["ma\x07rker inside box"], [], None, "'ma rker' is no name"),
        (["a/b/c/d inside box"], [], None, "'a/b/c/d' is no name"),
        (["--force inside box"], [], None, "'--force' is no name"),
        (["x" * 10_000], [], None, r"^'x{80}…' is no goal$"),
        (["a inside"], [], None, "'inside' takes a reference"),
        (["a scanned b"], [], None, "'scanned' takes no reference"),
        (["a handed left with the right arm"], [], None, "names two arms"),
        (["a inside b"], ["a inside table"], None, "can be stated of the table"),
        (["a inside b"], ["a center b"], None, "'center' is of the table alone"),
        (["a inside b"], ["a left_of"], None, "'left_of' takes a reference"),
        (["a inside b"], [], "", "--objects: '' is no object"),
        (["a inside b"], [], "two apple", "--objects: 'two apple' is no object"),
        (["a inside b"], [], "0 apple", "--objects: '0 apple' asks for 0"),
        (["a inside b"], [], "41 apple", "asks for 41; 1 to 40"),
        ([], ["a inside b"], None, "--start needs goals"),
        ([], [], "apple", "--objects needs goals"),
    ],
)
def test_a_goal_outside_the_grammar_is_named(goals, starts, objects, complaint: str):
    with pytest.raises(UsageError, match=complaint):
        StatedTask.of(goals, starts, objects)


def test_an_unknown_word_is_answered_with_the_nearest():
    with pytest.raises(UnknownName, match="unknown word in the goal 'a insde b': 'insde'") as caught:
        StatedTask.of(["a insde b"], [], None)
    assert "inside" in caught.value.hint


def test_provenance_keeps_the_given_text_and_no_more():
    assert said("a  back").record() == {"goals": ["a back"]}
    whole = said("a back", "then b back", starts=("a on b",), objects="a,  2 b").record()
    assert whole == {"goals": ["a back", "then b back"], "starts": ["a on b"], "objects": ["1 a", "2 b"]}
