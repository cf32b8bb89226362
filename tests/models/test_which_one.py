"""Objects that a noun may mean, and the words that identify one of them."""

from __future__ import annotations

import pytest

from tests.models.catalogue import CATALOGUE
from vcage.models.checked_reading import CheckedReading
from vcage.models.which_one import coloured, unclear
from vcage.objects.mentions import nouns
from vcage.schema.goals import AskedGoal, Description, Reading, goal_of

KINDS = {kind.name: kind for kind in CATALOGUE}
WHITE, RED = (KINDS["mug"].model_copy(update={"variants": [look]}) for look in KINDS["mug"].variants)
THINGS = {"mug_white": WHITE, "mug_red": RED, "plate": KINDS["plate"]}


def complaints(said: str, told: str | None = None) -> list[str]:
    """Complaints about a goal for the red mug, which some words may tell to be left of the white one."""
    asked = AskedGoal(goal=goal_of(["mug_red", "on", "plate"]), step=1, words=said)
    where = (
        [] if told is None else [Description(subject="mug_red", relation="left_of", reference="mug_white", words=told)]
    )
    reading = Reading(goals=[asked], descriptions=where)
    return list(unclear(CheckedReading(said, THINGS, reading=reading)))


def test_a_noun_that_two_objects_answer_to_is_unclear() -> None:
    assert complaints("put the mug on the plate") == ["nobody can tell which of mug_white, mug_red is meant by 'mug'"]


@pytest.mark.parametrize("noun", ["a mug", "the mugs", "the red mug"])
def test_a_noun_that_leaves_the_choice_or_says_more_is_clear(noun: str) -> None:
    assert complaints(f"put {noun} on the plate") == []


def test_a_description_tells_two_apart_only_by_a_word_for_its_relation() -> None:
    assert complaints("put the mug on the plate", told="the mug")
    assert complaints("put the mug on the plate", told="the mug on the left") == []


def test_a_colour_leaves_out_objects_of_another_one() -> None:
    (noun, _) = nouns("put the red mug on the plate", THINGS.values())
    assert coloured(noun, THINGS) == ["mug_red"]
