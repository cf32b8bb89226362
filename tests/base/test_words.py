from __future__ import annotations

import pytest

from vcage.base.words import is_plural, lemma


@pytest.mark.parametrize(
    ("plural", "singular"),
    [
        ("boxes", "box"),
        ("loaves", "loaf"),
        ("berries", "berry"),
        ("mugs", "mug"),
        ("dishes", "dish"),
        ("glass", "glass"),
    ],
)
def test_lemmas_are_singular(plural: str, singular: str) -> None:
    assert lemma(plural) == singular


@pytest.mark.parametrize("word", ["scissors", "chess", "bus", "box"])
def test_a_word_that_only_ends_like_a_plural_is_singular(word: str) -> None:
    assert not is_plural(word)
