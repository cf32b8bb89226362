"""The paper's five tasks, offline, over the library's own kinds."""

from __future__ import annotations

import numpy as np
import pytest

from tests.models.catalogue import unchecked
from vcage.models.rules.reasoner import OfflineReasoner
from vcage.objects.library import Library
from vcage.schema.asset import CatalogueEntry
from vcage.schema.plan import SelectedAsset
from vcage.schema.subtasks import ChainOption


@pytest.fixture(scope="module")
def kinds() -> list[CatalogueEntry]:
    """The kinds that need no package."""
    library = Library.load()
    return [library.entry(name) for name in library.names if library.annotation(name).source == "parametric"]


def select(instruction: str, kinds: list[CatalogueEntry], seed: int = 0) -> list[SelectedAsset]:
    return OfflineReasoner().select_assets(instruction, kinds, np.random.default_rng(seed), unchecked).objects


def assets(chosen: list[SelectedAsset], role: str) -> list[str]:
    return [thing.asset for thing in chosen if thing.role == role]


SOLD = {"food", "packed food", "bread", "fruit", "vegetable", "sweet", "condiment", "toiletries", "cosmetics"}


@pytest.mark.parametrize("seed", range(3))
def test_auto_checkout_has_products_scanner_scale_and_the_customers_side(kinds, seed: int) -> None:
    chosen = select(
        "Scan the products with the scanner, weigh the tomato on the electronic scale "
        "and place them on the customer side",
        kinds,
        seed,
    )
    by_name = {kind.name: kind.words for kind in kinds}
    contents = assets(chosen, "content")
    assert len(contents) == 4 and "tomato" in contents
    assert {by_name[name].category for name in contents} <= SOLD
    assert all("cashier_desk" in by_name[name].scene_tags for name in contents)
    assert assets(chosen, "receptacle") == ["electronic_scale", "customer_mat"]
    assert "barcode_scanner" in assets(chosen, "context")


@pytest.mark.parametrize("seed", range(3))
def test_pack_breads_has_five_different_breads(kinds, seed: int) -> None:
    chosen = select("Pack the five breads into the bread box", kinds, seed)
    contents = assets(chosen, "content")
    assert len(set(contents)) == 5
    assert {kind.words.category for kind in kinds if kind.name in contents} == {"bread"}
    assert assets(chosen, "receptacle") == ["bread_box"]


@pytest.mark.parametrize("seed", range(3))
def test_pack_stationery_has_pens_and_an_eraser(kinds, seed: int) -> None:
    chosen = select("Pack the marker pens and the eraser into the box", kinds, seed)
    assert assets(chosen, "content") == ["marker"] * 3 + ["whiteboard_eraser"]
    assert assets(chosen, "receptacle") == ["packaging_box"]


@pytest.mark.parametrize("seed", range(3))
def test_sort_to_cabinet_has_things_of_the_cabinet_and_several_drawers(kinds, seed: int) -> None:
    chosen = select("Sort the objects into the drawers of the cabinet", kinds, seed)
    by_name = {kind.name: kind for kind in kinds}
    contents = [by_name[name] for name in assets(chosen, "content")]
    assert len(contents) == 3
    assert all("cabinet" in kind.words.scene_tags and kind.contact_points for kind in contents)
    (place,) = assets(chosen, "receptacle")
    assert len(by_name[place].moving_parts) >= 2


@pytest.mark.parametrize("seed", range(3))
def test_pick_blocks_has_blocks_of_different_colours_and_a_plate(kinds, seed: int) -> None:
    chosen = select("Pick the blocks and put them on the plate", kinds, seed)
    assert assets(chosen, "content") == ["block"] * 3
    assert len({thing.variant for thing in chosen if thing.asset == "block"}) == 3
    assert assets(chosen, "receptacle") == ["plate"]


@pytest.mark.parametrize(
    ("instruction", "contents", "place"),
    [
        ("Put the blocks on the plate", {"block"}, "plate"),
        ("Put the apple into the bowl", {"apple"}, "bowl"),
        ("Put the pen into the mug", {"marker"}, "mug"),
        ("Put the eraser into the box", {"whiteboard_eraser"}, "packaging_box"),
        ("Put the screwdriver into the box", {"screwdriver"}, "packaging_box"),
        ("Put the soap on the dish", {"soap_bar"}, "soap_dish"),
        ("Put the pen in the tray", {"marker"}, "pen_tray"),
    ],
)
def test_a_word_that_several_kinds_share_means_the_plainest_that_fits(kinds, instruction, contents, place) -> None:
    chosen = select(instruction, kinds)
    assert set(assets(chosen, "content")) == contents
    assert assets(chosen, "receptacle") == [place]


def options_of(chosen: list[SelectedAsset], kinds: list[CatalogueEntry]) -> list[ChainOption]:
    """A sub-task for everything with a contact point, to every other thing that holds something."""
    by_name = {kind.name: kind for kind in kinds}
    look = {
        f"{thing.asset}_{number}": by_name[thing.asset].model_copy(
            update={"variants": [v for v in by_name[thing.asset].variants if v.id == thing.variant]}
        )
        for number, thing in enumerate(chosen)
    }
    return [
        ChainOption(
            id=f"{thing}-{place}",
            text=f"Move {thing} to {place}.",
            object=thing,
            receptacle=place,
            object_kind=look[thing],
            receptacle_kind=look[place],
        )
        for thing in look
        for place in look
        if thing != place and look[thing].contact_points and look[place].functional_points
    ]


def chained(instruction: str, kinds: list[CatalogueEntry], seed: int) -> tuple[list[str], list[str], set[str]]:
    """(ids of the contents, ids of what the chain moves, kinds of the places that it moves them to)."""
    chosen = select(instruction, kinds, seed)
    options = options_of(chosen, kinds)
    steps = {option.id: option for option in options}
    chain = [steps[step] for step in OfflineReasoner().compose_chain(instruction, options)]
    contents = [f"{thing.asset}_{number}" for number, thing in enumerate(chosen) if thing.role == "content"]
    return contents, [step.object for step in chain], {step.receptacle_kind.name for step in chain}


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("instruction", "place"),
    [
        ("Pack the five breads into the bread box", "bread_box"),
        ("Pack the marker pens and the eraser into the box", "packaging_box"),
        ("Sort the objects into the drawers of the cabinet", None),
        ("Pick the blocks and put them on the plate", "plate"),
        ("Put the products on the customer side", "customer_mat"),
        ("Put the groceries into the shopping basket", "shopping_basket"),
        ("Put the toiletries into the basket", None),
        ("Pack the stationery into the box", "packaging_box"),
        ("Put the torch into the box", "packaging_box"),
    ],
)
def test_a_chain_moves_each_content_once_to_the_place_that_was_selected(kinds, instruction, place, seed: int) -> None:
    contents, moved, places = chained(instruction, kinds, seed)
    assert contents and sorted(moved) == sorted(contents)
    assert places == set(assets(select(instruction, kinds, seed), "receptacle"))
    assert place is None or places == {place}


@pytest.mark.parametrize("seed", range(3))
def test_auto_checkout_brings_everything_to_the_customers_side_and_says_that_it_does_not_weigh(
    kinds, caplog, seed: int
) -> None:
    """A chain moves each object once, so the tomato passes the scale by."""
    contents, moved, places = chained(
        "Scan the products with the scanner, weigh the tomato on the electronic scale "
        "and place them on the customer side",
        kinds,
        seed,
    )
    assert sorted(moved) == sorted(contents) and places == {"customer_mat"}
    assert "not by way of 'electronic scale'" in caplog.text
