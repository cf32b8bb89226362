"""The rest of a sentence without its asides, and what these leave out."""

from __future__ import annotations

import pytest

from tests.models.catalogue import CATALOGUE
from vcage.models.asides import asked_part


def left(said: str) -> str:
    return " ".join(asked_part(said, CATALOGUE).text.replace(",", " ").split())


@pytest.mark.parametrize(
    ("said", "rest", "excluded"),
    [
        ("Put the mug, not the bowl, on the plate", "put the mug on the plate", ["bowl"]),
        ("All mugs except the red one go on the plate", "all mugs go on the plate", ["red one"]),
        ("Put the mug on the plate instead of the bowl", "put the mug on the plate", ["bowl"]),
        ("Neither the bagel nor the apple: put the mug away", ": put the mug away", ["bagel", "apple"]),
        ("Not only the mug but also the bowl", "not only the mug but also the bowl", []),
        ("The bowl isn't on the plate, the mug is", "the bowl the mug is", []),
        ("Put the mug on the plate, but the bagel goes in the bowl", None, []),
    ],
)  # fmt: skip
def test_an_aside_ends_with_its_nouns(said: str, rest: str | None, excluded: list[str]) -> None:
    found = asked_part(said, CATALOGUE)
    assert left(said) == (said.lower().replace(",", "") if rest is None else rest)
    assert [noun.words for noun in found.excluded] == excluded


def test_an_object_barred_from_a_place_is_kept_from_there() -> None:
    found = asked_part("Don't put the bagel in the bowl, put the apple there", CATALOGUE)
    assert [(noun.words, place and place.words) for noun, place in found.kept] == [("bagel", "bowl")]
    assert left("Don't put the bagel in the bowl, put the apple there") == "put the apple there"


def test_for_one_of_several_objects_none_must_be_answered() -> None:
    found = asked_part("Put the apple or the bagel in the bowl", CATALOGUE)
    assert "apple" not in found.text and "apple" in found.open_text


def test_words_before_a_correction_need_no_answer() -> None:
    assert left("Put the mug, sorry, the bowl on the plate") == "the bowl on the plate"
