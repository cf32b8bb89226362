"""Matching of words with the name of a kind: every word counts."""

from __future__ import annotations

import pytest

from tests.models.catalogue import entry
from vcage.objects.names import EXACT, HEAD, KIND, SYNONYM, best_looks, name_match

TEA = entry("tea_box", "box of tea", "packed food", ("green",), synonyms=("tea", "tea bags"))
APPLE = entry("apple", "apple", "fruit", ("red", "green"))
TRAY = entry("tray", "tray", "container", ("wood",))


@pytest.mark.parametrize(
    ("words", "level"),
    [
        (["box", "tea"], EXACT),
        (["tea", "box"], EXACT),
        (["tea"], SYNONYM),
        (["box"], HEAD),
        (["biscuit", "box"], 0),
        (["tea", "towel"], 0),
        (["packed", "food"], 0),
    ],
)
def test_words_name_a_kind_only_when_all_of_them_are_in_one_name(words: list[str], level: int) -> None:
    assert name_match(words, TEA, TEA.variants[0]) == level


def test_a_word_for_a_kind_of_kinds_names_its_members() -> None:
    assert name_match(["fruit"], APPLE, APPLE.variants[0]) == KIND


def test_a_word_may_state_the_material_of_a_look() -> None:
    assert name_match(["wooden", "tray"], TRAY, TRAY.variants[0]) == EXACT


def test_a_colour_leaves_the_looks_that_have_it() -> None:
    assert best_looks(["apple"], "green", APPLE) == (EXACT, [APPLE.variants[1]])
    assert best_looks(["apple"], "blue", APPLE)[0] == 0
