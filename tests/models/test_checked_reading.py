"""English is told from other languages."""

from __future__ import annotations

import pytest

from tests.models.catalogue import CATALOGUE
from vcage.models.checked_reading import in_english


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
def test_another_language_is_distinguished_from_english(said: str, english: bool) -> None:
    assert in_english(said, CATALOGUE) == english
