"""Words of an instruction, as they were typed."""

from __future__ import annotations

import pytest

from vcage.models.rules.tokens import as_typed


@pytest.mark.parametrize(
    ("instruction", "read", "typed"),
    [
        ("Carry it to the dining table", "dinging table", "dining table"),
        ("Put the fork down", "for", "fork"),
        ("Put the Red Mugs away", "red mug", "Red Mugs"),
        ("Take the FIRST-AID kit", "first aid kit", "FIRST-AID kit"),
        ("Open the drawer of the Cabinet", "drawer of cabinet", "drawer of the Cabinet"),
        ("Open the cabinet's top drawer", "top drawer of cabinet", "cabinet's top drawer"),
        ("Stack the red and the Blue blocks", "red block", "red blocks"),
        ("Take the torch, the Red one", "red one torch", "torch, the Red one"),
        ("Put the boxs there", "box", "boxs"),
    ],
)
def test_words_are_quoted_as_they_were_typed(instruction: str, read: str, typed: str) -> None:
    assert as_typed(instruction, read) == typed


def test_the_mention_that_was_read_is_quoted() -> None:
    instruction = "Put the mug on the tray and the MUG on the plate"
    assert as_typed(instruction, "mug", instruction.index("MUG") - 4) == "MUG"


def test_what_is_found_nowhere_is_quoted_from_its_place() -> None:
    assert as_typed("Put those on the plate", "them", 4, 9) == "those"
    assert as_typed("Put the rest away", "scanner") == "scanner"
