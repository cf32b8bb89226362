"""English is told from other languages, and a plain sentence from one that takes something back."""

from __future__ import annotations

import pytest

from tests.models.catalogue import CATALOGUE
from vcage.models.plain_english import in_english, is_plain


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
    assert in_english(said, CATALOGUE) == english


@pytest.mark.parametrize("said", ["the mug, sorry, the bowl", "all mugs except the red one", "do not move the plate"])
def test_what_takes_something_back_or_leaves_it_out_is_not_plain(said: str) -> None:
    assert not is_plain(said) and is_plain("Put the mug on the plate")
