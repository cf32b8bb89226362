"""Nouns, numbers and colours that are found in an instruction without a grammar."""

from __future__ import annotations

import pytest

from tests.models.catalogue import CATALOGUE, entry
from vcage.models.mentions import in_english, is_plain, mentions

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
def test_what_is_named_is_found_with_its_number(said: str, found: list[tuple[str, int | None]]) -> None:
    assert [(mention.words, mention.number) for mention in mentions(said, KINDS)] == found


def test_colours_belong_to_the_noun_after_them() -> None:
    (blocks, plate) = mentions("Put the red and blue blocks on the white plate", KINDS)
    assert sorted(blocks.colours) == ["blue", "red"] and plate.colours == ("white",)


def test_one_with_a_colour_is_any_object_of_that_colour() -> None:
    said = mentions("Put the mug on the plate and the red one too", KINDS)
    assert (said[-1].noun, said[-1].colours) == ((), ("red",))


@pytest.mark.parametrize(
    ("said", "english"),
    [
        ("Put the apple on the plate", True),
        ("Prepare breakfast for me", True),
        ("Leg den Apfel auf den Teller", False),
        ("Metti la banana in un vaso", False),
        ("Pon la manzana en el plato", False),
        ("把苹果放到盘子上", False),
        ("Положи яблоко на тарелку", False),
    ],
)
def test_another_language_is_told_from_english(said: str, english: bool) -> None:
    assert in_english(said, KINDS) == english


@pytest.mark.parametrize("said", ["the mug, sorry, the bowl", "all mugs except the red one", "do not move the plate"])
def test_what_takes_something_back_or_leaves_it_out_is_not_plain(said: str) -> None:
    assert not is_plain(said) and is_plain("Put the mug on the plate")
