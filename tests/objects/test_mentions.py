"""Nouns, numbers, colours and names that are found in a sentence without a grammar."""

from __future__ import annotations

import pytest

from tests.models.catalogue import CATALOGUE, entry
from vcage.base.words import tokens
from vcage.objects.mentions import find_names, full_names, nouns

KINDS = [
    *CATALOGUE,
    entry("can", "tin can", "packed food", synonyms=("can", "tin")),
    entry("timer", "egg timer", "tool"),
]


@pytest.mark.parametrize(
    ("said", "found"),
    [
        ("Put the two red mugs on the plate", [("two red mugs", 2), ("plate", None)]),
        ("Put both of the apples into the bowl", [("apples", 2), ("bowl", None)]),
        ("Put one of the two apples away", [("two apples", 1)]),
        ("Put the marker pens into the packaging box", [("marker pens", None), ("packaging box", None)]),
        ("Can you put the egg timer on the plate?", [("egg timer", None), ("plate", None)]),
        ("Book the stapler into the bread box", [("stapler", None), ("bread box", None)]),
        ("Put the apple juice on the plate", [("plate", None)]),
    ],
)
def test_a_named_object_is_found_with_its_number(said: str, found: list[tuple[str, int | None]]) -> None:
    assert [(noun.words, noun.number) for noun in nouns(said, KINDS)] == found


@pytest.mark.parametrize("said", ["Switch off the plate", "Put the mug down, then switch on the plate"])
def test_to_switch_on_or_off_names_no_switch(said: str) -> None:
    kinds = [*KINDS, entry("switch", "switch", "electronics")]
    assert "switch" not in [noun.words for noun in nouns(said, kinds)]
    assert [noun.words for noun in nouns("Press the switch", kinds)] == ["switch"]


def test_to_stand_something_up_names_no_stand() -> None:
    kinds = [*KINDS, entry("stand", "stand", "furniture")]
    for sentence in ("Stand up the tin can", "Stand tin can up", "Stand tin can upright on the table"):
        assert [noun.words for noun in nouns(sentence, kinds)] == ["tin can"]
    assert [noun.words for noun in nouns("Put the tin can on the stand", kinds)] == ["tin can", "stand"]


def test_colours_belong_to_the_noun_after_them() -> None:
    (blocks, plate) = nouns("Put the red and blue blocks on the white plate", KINDS)
    assert sorted(blocks.colours) == ["blue", "red"] and plate.colours == ("white",)


def test_one_with_a_colour_is_any_object_of_that_colour() -> None:
    said = nouns("Put the mug on the plate and the red one too", KINDS)
    assert (said[-1].name, said[-1].colours) == ((), ("red",))


def test_names_of_missing_objects_are_found() -> None:
    names = full_names([entry("banana", "banana", "fruit"), entry("can", "tin can", "packed food", synonyms=("can",))])
    assert find_names(tokens("Can you put the banana and a tin can in the box?"), names, taken=[]) == [
        "banana",
        "tin can",
    ]
    assert find_names(tokens("Can you put the banana away?"), names, taken=[4]) == []
