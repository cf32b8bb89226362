"""How the selection benchmark counts."""

from __future__ import annotations

from collections import Counter

import pytest
import yaml

from benchmarks.select import INSTRUCTIONS, Slot, run, score
from tests.models.catalogue import CATALOGUE
from vcage.schema.plan import SelectedAsset


def chosen(*names: str, role: str = "content") -> list[SelectedAsset]:
    colours = {kind.name: kind.variants[0].id for kind in CATALOGUE}
    return [SelectedAsset(asset=name, variant=colours[name], role=role, reason="") for name in names]


def slot(**fields) -> Slot:
    return Slot.read({"role": "content", **fields})


def test_a_slot_takes_no_more_than_its_count() -> None:
    tally = score("", [slot(kinds=["block"])], chosen("block", "block"), [], CATALOGUE)
    assert (tally.recall, tally.precision) == (1.0, 0.5)


def test_several_takes_all_and_wants_two() -> None:
    several = slot(kinds=["bagel", "croissant"], count="several")
    assert score("", [several], chosen("bagel"), [], CATALOGUE).recall == 0.0
    assert score("", [several], chosen("bagel", "croissant", "bagel"), [], CATALOGUE).precision == 1.0


def test_a_role_and_a_colour_must_agree() -> None:
    assert score("", [slot(kinds=["plate"])], chosen("plate", role="receptacle"), [], CATALOGUE).recall == 0.0
    assert score("", [slot(kinds=["block"], colour="blue")], chosen("block"), [], CATALOGUE).recall == 0.0


def test_context_and_optional_objects_are_not_wrong() -> None:
    extra = [*chosen("stapler", role="context"), *chosen("mug")]
    tally = score("", [slot(kinds=["block"])], [*chosen("block"), *extra], ["mug"], CATALOGUE)
    assert tally.precision == 1.0


def test_there_are_twelve_instructions_for_each_scene() -> None:
    cases = yaml.safe_load(INSTRUCTIONS.read_text(encoding="utf-8"))
    assert set(Counter(case["scene"] for case in cases).values()) == {12} and len(cases) == 60
    assert len({case["text"] for case in cases}) == 60


@pytest.mark.slow
def test_the_offline_reasoner_reaches_its_target() -> None:
    figures = run(quick=False)
    assert figures["recall"] >= 0.9 and figures["precision"] >= 0.85 and figures["instructions"] == 60
