"""Objects that are chosen for a sentence."""

from __future__ import annotations

import numpy as np
import pytest

from tests.models.catalogue import CATALOGUE
from tests.models.rules.scenes import kinds, read, selected
from vcage.base.errors import NoAssetFits, UnreadInstruction
from vcage.models.quantifiers import quantified
from vcage.models.rules.selection import select_assets


def chosen(sentence: str, role: str, seed: int = 0, scene: str = "table") -> list[str]:
    return [o.asset for o in selected(sentence, seed, scene).objects if o.role == role]


def test_the_same_seed_gives_the_same_objects() -> None:
    assert selected("Put three pens in the mug", 3) == selected("Put three pens in the mug", 3)


@pytest.mark.parametrize("name", ["the tomato juice", "the helicopter", "the chocolate egg"])
def test_a_name_with_words_foreign_to_its_kind_is_refused(name: str) -> None:
    with pytest.raises(NoAssetFits, match=name) as refused:
        selected(f"Put {name} in the basket")
    assert refused.value.details["unmatched"] == [name] and "nearest in meaning" in refused.value.hint


def test_a_colour_foreign_to_a_kind_is_refused_with_the_known_ones() -> None:
    with pytest.raises(NoAssetFits) as refused:
        selected("Put the purple apple in the bowl")
    assert "apple comes in red, green only" in refused.value.hint


@pytest.mark.parametrize("place", ["microwave", "red microwave", "steel microwave", "microwave oven"])
def test_the_microwave_that_a_thing_is_put_in_is_the_drawer_microwave(place: str) -> None:
    assert chosen(f"Open the {place}, put the mug in it and close it", "receptacle") == ["drawer_microwave"]


@pytest.mark.parametrize("out_of", ["out of", "from inside"])
def test_the_microwave_that_a_thing_is_taken_out_of_is_the_drawer_microwave(out_of: str) -> None:
    assert "drawer_microwave" in chosen(f"Take the mug {out_of} the microwave and put it on the table", "context")


@pytest.mark.parametrize("where", ["on", "next to"])
def test_the_microwave_that_a_thing_is_put_on_is_the_usual_one(where: str) -> None:
    assert chosen(f"Put the mug {where} the microwave", "receptacle") == ["microwave"]


@pytest.mark.parametrize(
    "sentence",
    [
        "Put the mug in the microwave and close the door",
        "Open the door of the microwave and put the mug in the microwave",
    ],
)
def test_a_microwave_that_a_thing_is_put_in_has_no_door(sentence: str) -> None:
    with pytest.raises(UnreadInstruction, match="things go in no microwave with a door"):
        selected(sentence)


def test_what_is_taken_out_is_taken_out_of_something() -> None:
    with pytest.raises(UnreadInstruction, match="say what it is taken out of"):
        selected("Open the drawer, take the stapler out and put it on the table")


@pytest.mark.parametrize("drawer", ["the drawer of the microwave", "the microwave drawer"])
def test_a_microwave_with_a_drawer_is_one_wherever_it_is_named(drawer: str) -> None:
    sentence = f"Put the mug next to the microwave and open {drawer}"
    assert chosen(sentence, "receptacle") == ["drawer_microwave"]


def test_a_thing_may_be_taken_out_of_a_rack_that_it_lies_on() -> None:
    assert "wine_rack" in chosen("Take the bottle out of the wine rack and put it on the table", "context")


@pytest.mark.parametrize(
    "sentence",
    [
        "Put the mug in the three-drawer cabinet",
        "Take the apple out of the stove and put it on the table",
    ],
    ids=["several drawers", "a top"],
)
def test_a_place_without_a_room_of_its_own_is_refused(sentence: str) -> None:
    with pytest.raises(UnreadInstruction, match="nothing can be put in it, or not without saying where"):
        selected(sentence)


def test_a_look_foreign_to_a_kind_is_refused_with_the_known_ones() -> None:
    with pytest.raises(NoAssetFits, match="'the partly eaten apple'") as refused:
        selected("Put the partly eaten apple in the bowl")
    hint = "'partly', 'eaten' are not known, and may be left out; apple comes in red, green only"
    assert refused.value.hint == hint


@pytest.mark.parametrize(
    ("noun", "word"),
    [("nice red mug", "nice"), ("lovely mug", "lovely"), ("lovely top drawer of the cabinet", "lovely")],
)
def test_a_word_that_no_name_has_may_be_left_out(noun: str, word: str) -> None:
    with pytest.raises(NoAssetFits, match=noun) as refused:
        selected(f"Put the apple in the {noun}")
    assert refused.value.hint.startswith(f"'{word}' is not known, and may be left out; ")


@pytest.mark.parametrize("noun", ["ceramic mug", "nice unicorn", "third mug"])
def test_a_word_without_which_nothing_is_named_or_that_is_known_is_not_left_out(noun: str) -> None:
    with pytest.raises(NoAssetFits, match=noun) as refused:
        selected(f"Put the {noun} in the bowl")
    assert "left out" not in refused.value.hint


@pytest.mark.parametrize("number", ["second", "dozen"])
def test_a_number_is_no_look(number: str) -> None:
    with pytest.raises(NoAssetFits) as refused:
        selected(f"Put the {number} apple in the bowl")
    assert refused.value.hint.startswith("nearest in meaning")


def test_a_part_that_its_owner_lacks_is_refused_with_those_it_has() -> None:
    with pytest.raises(NoAssetFits, match="middle drawer") as refused:
        selected("Open the middle drawer of the two-drawer cabinet")
    assert refused.value.hint == "the two-drawer cabinet has the bottom drawer, the top drawer"


def test_a_compartment_that_its_owner_lacks_is_refused_with_those_it_has() -> None:
    with pytest.raises(NoAssetFits, match="top compartment of the caddy") as refused:
        selected("Put the stamp in the top compartment of the caddy")
    for side in ("front", "back", "left", "right"):
        assert f"the {side} compartment" in refused.value.hint


def test_the_colour_of_the_owner_of_a_part_is_read() -> None:
    (caddy,) = selected("Put the stamp in the left compartment of the white caddy").objects[1:2]
    assert (caddy.asset, caddy.variant) == ("desk_caddy", "white")


def test_its_lid_is_that_of_a_thing_that_is_named() -> None:
    with pytest.raises(UnreadInstruction, match="nothing named before it has one"):
        selected("Put every apple in the box and close its lid")


@pytest.mark.parametrize(("amount", "count"), [("several", 3), ("a few", 3), ("a couple of", 2)])
def test_a_vague_amount_is_a_small_number(amount: str, count: int) -> None:
    assert chosen(f"Put {amount} apples in the basket", "content") == ["apple"] * count


@pytest.mark.parametrize(
    "sentence",
    ["Put the card in the holder", "Put the paper in the bin", "Put the lamp in the box", "Put the soap in the dish"],
)
def test_a_word_for_several_kinds_of_things_is_refused(sentence: str) -> None:
    with pytest.raises(UnreadInstruction, match="give its full name"):
        selected(sentence)


def test_a_box_for_shoes_is_no_shoe() -> None:
    assert chosen("Put the shoe in the basket", "content") == ["shoe"]


def test_the_stapler_that_is_pressed_is_not_the_one_that_is_carried() -> None:
    assert chosen("Press the stapler", "receptacle") == ["stapler_electric"]
    assert chosen("Put the stapler in the basket", "content") == ["stapler"]


def test_bottles_go_into_a_cabinet_with_tall_drawers() -> None:
    sentence = "Put the wine bottle in the bottom drawer of the cabinet"
    assert chosen(sentence, "receptacle") == ["tall_drawer_cabinet"]


def test_fries_are_one_portion() -> None:
    assert chosen("Put the fries on the tray", "content") == ["french_fries"]


def look_of(sentence: str, asset: str) -> str:
    return next(o.variant for o in selected(sentence).objects if o.asset == asset)


@pytest.mark.parametrize(
    ("sentence", "asset", "colour"),
    [
        ("Put the pink block on the plate", "block", "pink"),
        ("Put the apple in the yellow basket", "basket", "yellow"),
        ("Put the yellow and white mug on the plate", "mug", "yellow_and_white"),
        ("Put the white mug on the plate", "mug", "white"),
    ],
)
def test_a_look_has_the_colours_that_were_asked_for(sentence: str, asset: str, colour: str) -> None:
    assert look_of(sentence, asset) == colour


def test_of_two_kinds_with_one_name_that_comes_which_has_the_colour_unpainted() -> None:
    assert look_of("Put the black bowl in the basket", "small_bowl") == "black"


def test_of_two_kinds_with_one_name_that_comes_which_fits_the_place() -> None:
    assert "small_bowl" in chosen("Put the bowl in the top drawer of the cabinet", "content")
    assert "bowl" in chosen("Put the banana in the bowl", "receptacle")


@pytest.mark.parametrize("sentence", ["Put the blue can on the tray", "Put the red can next to the grey can"])
def test_a_can_in_a_colour_that_cans_lack_is_no_trash_can(sentence: str) -> None:
    with pytest.raises(NoAssetFits) as refused:
        selected(sentence)
    assert "can comes in red, green" in refused.value.hint


def test_a_can_of_another_kind_that_comes_in_the_colour_is_meant() -> None:
    assert chosen("Put the silver can in the basket", "content") == ["energy_drink"]
    assert chosen("Throw the apple in the blue trash can", "receptacle") == ["dustbin"]


@pytest.mark.parametrize(("count", "why"), [("no", "nobody can tell"), ("200", "so many"), ("40", "so many")])
def test_none_and_more_than_a_table_holds_are_refused(count: str, why: str) -> None:
    with pytest.raises(UnreadInstruction, match=why):
        selected(f"Put {count} apples in the basket")


@pytest.mark.parametrize("seed", range(4))
def test_clutter_excludes_everything_meant_by_everything(seed: int) -> None:
    sentence = "Everything goes into the packaging box"
    entries = {entry.name: entry for entry in kinds()}
    by = [entries[name] for name in chosen(sentence, "context", seed)]
    assert not any(quantifier.covers(entry) for quantifier in quantified(sentence) for entry in by)


def test_objects_of_the_scene_are_preferred() -> None:
    entries = {entry.name: entry for entry in kinds()}
    for seed in range(3):
        found = chosen("Put the objects into the basket", "content", seed, scene="bathroom")
        assert all("bathroom" in entries[name].words.scene_tags for name in found)


def test_tools_have_their_role() -> None:
    sentence = "Weigh the chocolate bar, scan it and show the payment sign to the customer"
    assert set(chosen(sentence, "tool")) == {"electronic_scale", "barcode_scanner", "payment_sign"}
    assert chosen(sentence, "content") == ["chocolate_bar"]


def test_a_container_is_the_one_on_the_plate() -> None:
    entries = {entry.name: entry for entry in kinds()}
    (name,) = chosen("Place the container onto the plate", "content")
    assert entries[name].functional_points[0].holds == "in" and max(entries[name].size[:2]) < 0.21


def test_exceptions_stand_there_too() -> None:
    found = selected("Put all the pens except the red one into the box").objects
    assert ("marker", "red", "context") in [(o.asset, o.variant, o.role) for o in found]
    assert [o.variant for o in found if o.asset == "marker" and o.role == "content"].count("red") == 0


def test_a_small_catalogue_without_sizes_will_do() -> None:
    found = select_assets("Put the blocks on the plate", CATALOGUE, np.random.default_rng(0)).objects
    assert [o.asset for o in found if o.role == "content"] == ["block"] * 2


def test_an_exception_that_leaves_nothing_is_refused() -> None:
    with pytest.raises(UnreadInstruction, match="nothing is left without it"):
        selected("Put the mugs except the mugs in the box")


def test_an_exception_among_parts_is_refused() -> None:
    with pytest.raises(UnreadInstruction, match="name each part that is meant"):
        selected("Open all drawers except the top one")


@pytest.mark.parametrize("sentence", ["Put the other mug on the plate", "Put another mug on the plate"])
def test_the_other_one_without_a_first_is_refused(sentence: str) -> None:
    with pytest.raises(UnreadInstruction, match="nobody can tell which"):
        selected(sentence)


def test_the_other_one_is_of_the_kind_that_was_named() -> None:
    sentence = "Put the red mug in the box and the other mug on the plate"
    assert chosen(sentence, "content") == ["mug", "mug"]


def test_an_exception_from_them_is_one_of_them() -> None:
    selection, reading = read("Scan the cans, then put them in the basket except the green one")
    cans = [o for o in selection.objects if o.asset == "can"]
    moved = [asked.goal for asked in reading.goals if asked.goal.relation == "inside"]
    assert len(moved) == len(cans) - 1


def test_the_red_one_after_the_place_is_one_of_the_things() -> None:
    found = selected("Put all the pens into the box except the red one").objects
    assert ("marker", "red", "context") in [(o.asset, o.variant, o.role) for o in found]
    assert "first_aid_kit" not in [o.asset for o in found]  # a red box
    found = selected("Put all apples in the bowl except a red one").objects
    assert ("apple", "red", "context") in [(o.asset, o.variant, o.role) for o in found]


def test_an_exception_that_no_kind_is_called_is_refused() -> None:
    with pytest.raises(NoAssetFits, match="unicorn"):
        selected("Put all pens in the box except the unicorn")


def starts(sentence: str) -> dict[str, str | None]:
    """Where the chosen kinds start."""
    return {o.asset: o.starts_in for o in selected(sentence).objects if o.role != "context" or o.starts_in}


def test_a_vessel_that_is_emptied_starts_with_balls_in_it() -> None:
    assert starts("Empty the mug into the bowl") == {"mug": None, "ball": "mug", "bowl": None}


def test_a_rack_on_which_a_mug_is_hung_is_one_with_pegs() -> None:
    assert chosen("Hang the red mug on the rack", "receptacle") == ["mug_rack"]
    assert chosen("Hang the red mug on the rack", "content") == ["mug"]


def test_a_mug_is_hung_on_a_mug_rack_where_no_place_is_named() -> None:
    assert chosen("Hang up the mug", "receptacle") == ["mug_rack"]


def test_the_rack_on_which_a_mug_is_put_may_be_one_to_hang_it_on() -> None:
    with pytest.raises(UnreadInstruction, match="it may be the mug rack or the wine rack; say hang, or give the full"):
        selected("Put the mug on the rack")
    assert chosen("Put the wine bottle on the rack", "receptacle") == ["wine_rack"]


def test_the_dish_is_the_one_that_was_named_before_and_the_dishes_are_crockery() -> None:
    sentence = "Put the soap in the soap dish and the lemon next to the dish"
    assert chosen(sentence, "receptacle") == ["soap_dish"]
    assert chosen("Put the dishes in the basket", "content")


@pytest.mark.parametrize(
    "sentence",
    [
        "Insert the peg into the hole",
        "Put the peg in the peg block",
        "Push the peg into the peg hole",
        "Insert the peg",
        "Insert the peg that is next to the mug",
        "Insert the peg, then put the apple in the bowl",
    ],
)
def test_a_peg_is_chosen_with_a_block_that_has_a_hole(sentence: str) -> None:
    assert "peg" in chosen(sentence, "content") and "peg_block" in chosen(sentence, "receptacle")


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    "sentence", ["Pour the balls from the small bin into the dustbin", "Pour the ball from the cup into the bowl"]
)
def test_balls_that_are_poured_have_other_colours_than_what_they_lie_in(sentence: str, seed: int) -> None:
    found = selected(sentence, seed).objects
    around = {o.variant for o in found if o.asset in ("small_bin", "dustbin", "cup", "bowl")}
    assert around.isdisjoint(o.variant for o in found if o.asset == "ball")


@pytest.mark.parametrize("seed", range(4))
def test_as_many_of_several_things_are_chosen_as_their_place_takes(seed: int) -> None:
    found = selected("Put every bread in the basket", seed).objects
    assert sum(o.role == "content" for o in found) == 2


@pytest.mark.parametrize("sentence", ["Stack all the blocks on the coaster", "Pour all the balls into the small bowl"])
def test_what_is_stacked_or_poured_needs_no_room_side_by_side(sentence: str) -> None:
    assert sum(o.asset in ("block", "ball") for o in selected(sentence).objects) == 3


def test_the_block_is_not_the_peg_block_that_nobody_named() -> None:
    assert chosen("Insert the peg and hit the block with the hammer", "content") == ["peg", "block"]


@pytest.mark.parametrize(
    "sentence", ["Put all the mugs next to the plate", "Scan all the cereal boxes with the barcode scanner"]
)
def test_a_neighbour_and_a_tool_do_not_limit_how_many_things_are_chosen(sentence: str) -> None:
    assert len(chosen(sentence, "content")) == 3


def test_balls_that_are_poured_start_in_a_cup_where_no_vessel_is_named() -> None:
    assert starts("Pour five small balls into the dustbin") == {"ball": "cup", "cup": None, "dustbin": None}
    assert chosen("Pour five small balls into the dustbin", "content").count("ball") == 5


@pytest.mark.parametrize(
    ("sentence", "why"),
    [
        ("Stand the fallen one up", "nothing before it says which of several things is meant"),
        ("Put the block on top", "on top of which thing"),
        ("Put the bowl on the plate and put the apple on top", "on top of which thing"),
        ("Put the apple on the left side", "no goal names this side"),
        ("Move the can to the side", "no goal names this side"),
        ("Put the apple in the area", "no goal names this area"),
        ("Put the glass on the tray", "give its full name"),
        ("Put the ball next to the bowl", "balls are only poured"),
        ("Put the apple in the bowl next to the glass", "give its full name"),
        ("Open the drawer slightly", "how far"),
        ("Insert the peg halfway into the hole", "how far"),
        ("Insert the peg half-way into the hole", "how far"),
        ("Slowly put the apple in the bowl", "how fast"),
        ("Push the apple in", "nothing that is there is called so"),
        ("Insert the peg that is in the box", "it can mean two things"),
        ("Put all four blocks except the red one in the box", "its number may count what is excepted"),
        ("Put all three red and blue blocks in the box", "say it of each, as in: two red and two blue blocks"),
        ("Lift two red and blue mugs", "its number may be of one colour, or of all"),
        ("Pour some of the balls from the cup into the bowl", "nobody can tell which of them"),
        ("Push in the timer", "no goal pushes in kitchen_timer.*: a drawer is pushed in"),
        ("Press the apple in with the left arm", "no goal pushes in apple"),
        ("Push in the drawer and the apple", "no goal pushes in apple"),
        ("Insert the battery", "no peg that goes into a hole"),
        ("Put every block on its plate", "a place of its own"),
        ("Hit the block with the hammer twice", "how often"),
        ("Shake the bottle vigorously", "how hard"),
        ("Turn the tap to the left", "in which direction"),
        ("Lift the pot to the right with the left arm", "in which direction"),
        ("Show the payment sign to the right to the customer", "in which direction"),
        (
            "Put the apple on the plate, then wipe the plate with the sponge",
            "apple_.* on plate_.* and then plate_.* wiped",
        ),
    ],
)
def test_words_that_say_too_little_are_refused(sentence: str, why: str) -> None:
    with pytest.raises(UnreadInstruction, match=why):
        selected(sentence)


@pytest.mark.parametrize(
    "sentence",
    [
        "Insert the peg into the left hole of the block",
        "Insert the peg into the red hole in the blue block",
        "Insert the peg into the hole in each block",
        "Insert the peg into the hole in the fallen block",
        "Put the block on the plate, then insert the peg into its hole",
        "Hit the block with the hammer, then insert the peg into the hole of the block",
    ],
)
def test_a_hole_that_no_block_has_as_it_is_said_is_refused(sentence: str) -> None:
    with pytest.raises((UnreadInstruction, NoAssetFits)):
        selected(sentence)


def test_the_block_that_has_the_hole_stands_where_it_is_said_to_stand() -> None:
    _, reading = read("Insert the peg into the hole in the block in the middle of the table")
    assert [(d.relation, d.reference) for d in reading.descriptions] == [("center", "table")]


@pytest.mark.parametrize(
    "sentence",
    [
        "Hand the red block to the right arm",
        "Pick up the block and hand it to the left arm",
        "Pick up the red block and hand the block to the right arm",
    ],
)
def test_the_block_that_changes_hands_is_a_long_one(sentence: str) -> None:
    assert chosen(sentence, "content") == ["long_block"]


@pytest.mark.parametrize("sentence", ["Hand the cube to the right arm", "Hand the small block to the right arm"])
def test_only_a_block_that_may_be_long_is_a_long_one(sentence: str) -> None:
    assert "long_block" not in chosen(sentence, "content")


def test_a_block_that_changes_hands_is_the_one_of_all_commands() -> None:
    chosen = [
        o.asset for o in selected("Put the apple next to the block, then hand the block to the right arm").objects
    ]
    assert "long_block" in chosen and "block" not in chosen


def test_the_block_is_no_long_one_where_another_block_is_named() -> None:
    assert "long_block" not in chosen(
        "Hand the red block to the right arm, then put the blue block on the plate", "content"
    )
