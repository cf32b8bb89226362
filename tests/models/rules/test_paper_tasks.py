"""The paper's five tasks, offline, over the library's own kinds."""

from __future__ import annotations

import numpy as np
import pytest

from tests.models.catalogue import unchecked
from vcage.models.checked_reading import Instructed
from vcage.models.rules.reasoner import OfflineReasoner
from vcage.models.second_look import second_look
from vcage.models.selection_check import entries_of, name_objects
from vcage.objects.library import Library
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import Goal
from vcage.schema.plan import SelectedAsset, Selection


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
    assert assets(chosen, "receptacle") == ["customer_mat"]
    assert set(assets(chosen, "tool")) == {"electronic_scale", "barcode_scanner"}


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
def test_sort_to_cabinet_has_things_of_the_cabinets_scene_and_several_drawers(kinds, seed: int) -> None:
    chosen = select("Sort the objects into the drawers of the cabinet", kinds, seed)
    by_name = {kind.name: kind for kind in kinds}
    contents = [by_name[name] for name in assets(chosen, "content")]
    assert len(contents) == 3
    (place,) = assets(chosen, "receptacle")
    around = {*by_name[place].words.scene_tags}
    assert all(around & {*kind.words.scene_tags} and kind.contact_points for kind in contents)
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
    ],
)
def test_a_word_that_several_kinds_share_means_the_plainest_that_fits(kinds, instruction, contents, place) -> None:
    chosen = select(instruction, kinds)
    assert set(assets(chosen, "content")) == contents
    assert assets(chosen, "receptacle") == [place]


def asked(instruction: str, kinds: list[CatalogueEntry], seed: int) -> tuple[list[SelectedAsset], list[Goal]]:
    """The objects chosen for an instruction, and the goals then read in it."""
    chosen = select(instruction, kinds, seed)
    named = name_objects(Selection(objects=chosen), kinds)
    things = entries_of(named, kinds)
    return chosen, [a.goal for a in OfflineReasoner().read_goals(Instructed(instruction, things)).goals]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("instruction", "place"),
    [
        ("Pack the five breads into the bread box", "bread_box"),
        ("Pack the marker pens and the eraser into the box", "packaging_box"),
        ("Sort the objects into the drawers of the cabinet", "cabinet"),
        ("Pick the blocks and put them on the plate", "plate"),
        ("Put the products on the customer side", "customer_mat"),
        ("Put the groceries into the shopping basket", "shopping_basket"),
        ("Put the toiletries into the basket", "basket"),
        ("Pack the stationery into the box", "packaging_box"),
        ("Put the torch into the box", "packaging_box"),
    ],
)
def test_a_goal_for_each_content_in_the_place_that_was_selected(kinds, instruction, place, seed: int) -> None:
    chosen, goals = asked(instruction, kinds, seed)
    assert len(goals) == len(assets(chosen, "content"))
    assert len({goal.subject for goal in goals}) == len(goals)
    assert all(place in str(goal.reference) for goal in goals)


@pytest.mark.parametrize("seed", range(3))
def test_auto_checkout_scans_weighs_and_brings_everything_to_the_customers_side(kinds, seed: int) -> None:
    chosen, goals = asked(
        "Scan the products with the scanner, weigh the tomato on the electronic scale "
        "and place them on the customer side",
        kinds,
        seed,
    )
    count = len(assets(chosen, "content"))
    assert [goal.relation for goal in goals] == ["scanned"] * count + ["weighed"] + ["on"] * count


def test_two_things_go_into_separate_drawers_that_are_opened_and_closed(kinds) -> None:
    text = (
        "Open the top drawer, put the padlock in it and close it, "
        "then open the bottom drawer, put the tape measure in it and close it"
    )
    _, goals = asked(text, kinds, 0)
    assert [(goal.relation, goal.part) for goal in goals] == [
        (word, drawer) for drawer in ("drawer_top", "drawer_bottom") for word in ("open", "inside", "closed")
    ]


@pytest.mark.parametrize(
    ("instruction", "goals"),
    [
        ("Pick four blocks and put them on the plate", 4),
        ("Collect three marker pens and a whiteboard eraser, and place them into the packaging box", 4),
        ("Gather the two lemons and put them in the basket", 2),
        ("Weigh the chocolate bar, scan it and show the payment sign to the customer", 3),
    ],
)
def test_a_sentence_that_picks_first_is_read_and_covers_every_word(kinds, instruction: str, goals: int) -> None:
    things = entries_of(name_objects(Selection(objects=select(instruction, kinds)), kinds), kinds)
    told = Instructed(instruction, things)
    reading = OfflineReasoner().read_goals(told)
    assert len(reading.goals) == goals
    assert second_look(told, reading) == []
