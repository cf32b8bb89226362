"""Wishes that the robot cannot be told."""

from __future__ import annotations

import numpy as np
import pytest

from tests.models.catalogue import CATALOGUE
from vcage.base.errors import UnreadInstruction
from vcage.models.rules.selection import select_assets


@pytest.mark.parametrize(
    ("instruction", "words", "instead"),
    [
        ("Hand the block to the other arm", "the other arm", "'to the left arm'"),
        ("Pass the block to another hand and put it on the plate", "another hand", "'to the left arm'"),
        ("Sort the blocks by colour", "by colour", "say where each thing goes"),
        ("Place the cup upside down on the plate", "upside down", "leave it out"),
    ],
)
def test_what_can_be_said_instead_is_in_the_hint(instruction: str, words: str, instead: str):
    with pytest.raises(UnreadInstruction, match=f"^'{words}' in '{instruction}' is not understood") as caught:
        select_assets(instruction, CATALOGUE, np.random.default_rng(0))
    assert instead in caught.value.hint


@pytest.mark.parametrize("instruction", ["Hand the block to the left arm", "Put the red block by the plate"])
def test_what_names_an_arm_or_a_place_is_understood(instruction: str):
    assert select_assets(instruction, CATALOGUE, np.random.default_rng(0))
