from __future__ import annotations

import numpy as np
import pytest

from tests.models.catalogue import CATALOGUE
from vcage.base.errors import InfeasibleScene, NoAssetFits, UnreadInstruction
from vcage.models.rules.selection import select_assets


def select(instruction: str) -> None:
    select_assets(instruction, CATALOGUE, np.random.default_rng(0))


@pytest.mark.parametrize(
    ("instruction", "named"),
    [
        ("Bring the helicopter to the moon", ["helicopter", "moon"]),
        ("Put the bread into the cupboard", ["cupboard"]),
        ("Put the submarine on the plate", ["submarine"]),
        ("Put the purple block on the plate", ["purple block"]),
        ("Put the Fork on the Dining table", ["Fork", "Dining table"]),
        ("Put the forks on the plate", ["forks"]),
        ("Put the HELI-copter on the plate", ["HELI-copter"]),
    ],
)
def test_what_matches_nothing_is_named(instruction: str, named: list[str]) -> None:
    with pytest.raises(NoAssetFits) as caught:
        select(instruction)
    assert caught.value.details["unmatched"] == named
    assert all(name in caught.value.message for name in named) and caught.value.hint


@pytest.mark.parametrize("instruction", ["", "   ", "Tidy up", "???"])
def test_an_instruction_that_names_nothing_is_refused(instruction: str) -> None:
    with pytest.raises(UnreadInstruction):
        select(instruction)


@pytest.mark.parametrize("number", ["0", "zero", "a hundred", "99999999999"])
def test_a_number_that_no_table_holds_is_refused(number: str) -> None:
    with pytest.raises(InfeasibleScene, match="'Blocks'"):
        select(f"Put {number} Blocks on the plate")


def test_what_only_qualifies_a_name_is_not_that_thing() -> None:
    with pytest.raises(NoAssetFits, match="whiteboard"):
        select("Put the whiteboard into the box")


@pytest.mark.parametrize(
    ("instruction", "named"),
    [
        ("Put the apple's stem on the plate", "apple's stem"),
        ("Put the apple\u2019s stem on the plate", "apple\u2019s stem"),
        ("Put the stem of the apple on the plate", "stem of the apple"),
        ("Put the rim of the mug on the plate", "rim of the mug"),
    ],
)
def test_a_piece_of_a_thing_is_not_that_thing(instruction: str, named: str) -> None:
    with pytest.raises(NoAssetFits) as caught:
        select(instruction)
    assert caught.value.details["unmatched"] == [named]


def test_the_nearest_in_meaning_are_suggested_for_what_matches_nothing() -> None:
    with pytest.raises(NoAssetFits) as caught:
        select("Put the pupil's stationery set into the box")
    assert "nearest in meaning" in caught.value.hint and caught.value.details["nearest"]


def test_an_exception_that_the_catalogue_does_not_have_is_no_crash() -> None:
    select("Put the blocks on the plate except the purple one")
