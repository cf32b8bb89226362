from __future__ import annotations

import numpy as np
import pytest

from tests.models.catalogue import CATALOGUE, KITCHEN, entry, unchecked
from vcage.base.errors import NoAssetFits
from vcage.models.rules.reasoner import OfflineReasoner
from vcage.schema.plan import SelectedAsset, Selection


def select(instruction: str, seed: int = 0) -> list[SelectedAsset]:
    return OfflineReasoner().select_assets(instruction, CATALOGUE, np.random.default_rng(seed), unchecked).objects


def assets(instruction: str, role: str, seed: int = 0) -> list[str]:
    return [o.asset for o in select(instruction, seed) if o.role == role]


@pytest.mark.parametrize("seed", range(4))
def test_pens_and_eraser_into_the_box(seed: int) -> None:
    chosen = select("Pack the marker pens and the eraser into the box", seed)
    pens = [o.variant for o in chosen if o.asset == "marker_pen"]
    assert len(pens) == len(set(pens)) == 3
    assert [o.asset for o in chosen if o.role != "context"][3:] == ["whiteboard_eraser", "packaging_box"]


@pytest.mark.parametrize("seed", range(4))
def test_blocks_come_in_different_colours(seed: int) -> None:
    chosen = select("Put the blocks on the plate", seed)
    assert len({o.variant for o in chosen if o.asset == "block"}) == 3
    assert assets("Put the blocks on the plate", "receptacle", seed) == ["plate"]


@pytest.mark.parametrize("instruction", ["Put the bread into the bread box", "Put the breads in the bread box"])
def test_bread_means_several_kinds_of_bread(instruction: str) -> None:
    assert sorted(assets(instruction, "content")) == ["bagel", "baguette_piece", "croissant"]
    assert assets(instruction, "receptacle") == ["bread_box"]


def test_a_number_is_kept_even_beyond_the_variants() -> None:
    assert assets("Put five markers in the mug", "content") == ["marker_pen"] * 5


def test_a_colour_chooses_the_variant() -> None:
    assert [o.variant for o in select("Put the green apple in the bowl") if o.role == "content"] == ["green"]


def test_each_clause_has_its_receptacle() -> None:
    assert assets("Put an apple in the bowl and the stapler into the box", "receptacle") == ["bowl", "packaging_box"]


@pytest.mark.parametrize("seed", range(6))
def test_context_fits_the_occasion_and_is_not_confused_with_the_contents(seed: int) -> None:
    context = assets("Put the bread into the bread box", "context", seed)
    assert len(context) == 2 and not set(context) & {"croissant", "bagel", "baguette_piece", "packaging_box", "stapler"}


def test_the_same_seed_gives_the_same_selection_whatever_the_catalogues_order() -> None:
    backwards = OfflineReasoner().select_assets(
        "Put the bread into the bread box", CATALOGUE[::-1], np.random.default_rng(5), unchecked
    )
    assert backwards.objects == select("Put the bread into the bread box", 5)


@pytest.mark.parametrize(
    ("number", "count"), [("twelve", 12), ("a dozen", 12), ("two dozen", 24), ("twenty-five", 25), ("12", 12)]
)
def test_large_numbers_are_read(number: str, count: int) -> None:
    assert assets(f"Put {number} blocks on the plate", "content") == ["block"] * count


def test_a_thing_goes_on_its_own_like_in_another_colour() -> None:
    chosen = select("Put the red block on the blue block")
    assert [(o.asset, o.variant, o.role) for o in chosen][:2] == [
        ("block", "red", "content"),
        ("block", "blue", "receptacle"),
    ]


def test_a_thing_on_itself_is_refused_in_clear_words() -> None:
    with pytest.raises(NoAssetFits, match="same thing: block"):
        select("Put the red block on the red block")


def test_a_tool_that_is_not_named_stands_by_as_context() -> None:
    scanner = entry("barcode_scanner", "barcode scanner", "machine", ("black",))
    kinds = [*CATALOGUE, scanner]
    chosen = OfflineReasoner().select_assets("Scan the apple", kinds, np.random.default_rng(0), unchecked).objects
    assert [(o.asset, o.role) for o in chosen][:2] == [("apple", "content"), ("barcode_scanner", "context")]


def test_what_is_left_out_is_there_but_not_moved() -> None:
    chosen = select("Put all the markers except the red one into the box")
    assert ("marker_pen", "red", "context") in [(o.asset, o.variant, o.role) for o in chosen]


def test_a_place_made_for_the_thing_comes_before_others_of_its_name() -> None:
    assert assets("Put the bread into the box", "receptacle") == ["bread_box"]
    assert assets("Put the stapler into the box", "receptacle") == ["packaging_box"]


BASKET = entry("basket", "basket", "container", ("brown",), KITCHEN, size=(0.25, 0.2, 0.1), holds="in")


_CHEST = entry("chest", "chest", "container", ("brown",), KITCHEN, size=(0.25, 0.2, 0.1), holds="in")
CHEST = _CHEST.model_copy(
    update={"functional_points": [p.model_copy(update={"link": "drawer"}) for p in _CHEST.functional_points]}
)


def selection(instruction: str) -> Selection:
    kinds = [*CATALOGUE, BASKET, CHEST]
    return OfflineReasoner().select_assets(instruction, kinds, np.random.default_rng(0), unchecked)


def starts(instruction: str) -> list[tuple[str, str, str | None]]:
    """(asset, role, what it starts in) of all but what is there for the occasion."""
    chosen = selection(instruction).objects
    return [(o.asset, o.role, o.starts_in) for o in chosen if not o.reason.startswith("belongs")]


@pytest.mark.parametrize(
    "instruction",
    [
        "Take the apple out of the basket and put it on the plate",
        "Move the apple from the basket to the plate",
        "Remove the apple from the basket, then place it on the plate",
    ],
)
def test_what_is_taken_out_of_something_starts_in_it(instruction: str) -> None:
    assert starts(instruction) == [
        ("apple", "content", "basket"), ("plate", "receptacle", None), ("basket", "context", None),
    ]  # fmt: skip


def test_what_is_emptied_holds_small_things_that_are_not_named() -> None:
    chosen = starts("Empty the basket onto the plate")
    assert chosen[2:] == [("plate", "receptacle", None), ("basket", "context", None)]
    assert [(role, place) for _, role, place in chosen[:2]] == [("content", "basket")] * 2


def test_a_place_that_is_both_emptied_and_filled_is_a_receptacle() -> None:
    chosen = starts("Take the apple out of the basket and put it on the plate, then put the stapler into the basket")
    assert ("apple", "content", "basket") in chosen and ("basket", "receptacle", None) in chosen


def test_what_is_taken_from_the_table_starts_there() -> None:
    assert starts("Take the apple from the table and put it on the plate")[0] == ("apple", "content", None)


@pytest.mark.parametrize("source", ["stapler", "block"])
def test_what_holds_nothing_is_noted_and_left_alone(source: str) -> None:
    chosen = selection(f"Take the book out of the {source} and put it on the plate")
    assert (chosen.objects[0].asset, chosen.objects[0].starts_in) == ("book", None)
    assert chosen.notes == [f"'book' starts on the table: nothing called '{source}' holds things"]


def test_what_is_too_large_for_its_start_is_noted_and_starts_beside_it() -> None:
    chosen = selection("Take the book out of the mug and put it on the plate")
    assert (chosen.objects[0].asset, chosen.objects[0].starts_in) == ("book", None)
    assert "mug" in [o.asset for o in chosen.objects]
    assert chosen.notes == ["'book' starts on the table: the mug is too small for the book"]


def test_what_would_start_in_a_closed_drawer_is_noted_and_starts_beside_it() -> None:
    chosen = selection("Take the apple out of the chest and put it on the plate")
    assert [o.starts_in for o in chosen.objects if o.asset == "apple"] == [None]
    assert "chest" in [o.asset for o in chosen.objects]
    assert chosen.notes == ["'apple' starts on the table: the chest is closed then"]
