from __future__ import annotations

import pytest

from benchmarks.instructions import load_scenes
from vcage.base.errors import UnreadInstruction
from vcage.models.rules.goals import read_goals
from vcage.schema.goals import Reading

SCENES = load_scenes()


def reading(scene: str, instruction: str) -> Reading:
    return read_goals(instruction, SCENES[scene])


def goals(scene: str, instruction: str) -> list[str]:
    return [str(asked.goal) for asked in reading(scene, instruction).goals]


def test_a_drawer_is_named_by_where_it_is() -> None:
    found = goals("office_desk", "Open the top drawer, put the stapler in it and close it")
    cabinet = "cabinet_two_drawers_walnut/drawer_top"
    assert found == [f"{cabinet} open", f"stapler_black inside {cabinet}", f"{cabinet} closed"]


def test_every_goal_has_the_words_that_ask_for_it() -> None:
    found = reading("kitchen", "Put the banana in the pot and turn the tap on").goals
    assert [asked.words for asked in found] == ["Put the banana in the pot", "turn the tap on"]


@pytest.mark.parametrize(
    ("scene", "instruction", "expected"),
    [
        ("kitchen", "Put the green apple on the blue plate", ["apple_green on plate_blue"]),
        ("kitchen", "Put the spoon next to the salt", ["spoon_wood beside salt_shaker_salt"]),
        ("kitchen", "Turn on the faucet", ["tap_chrome/lever turned"]),
        ("cashier_desk", "Ring the bell", ["service_bell_silver/button pressed"]),
        ("cashier_desk", "Scan the cereals", ["cereal_box_honey scanned"]),
        ("cashier_desk", "Weigh the lemon", ["lemon_ripe weighed"]),
        ("cashier_desk", "Scan and weigh the lemon", ["lemon_ripe scanned", "lemon_ripe weighed"]),
        ("cashier_desk", "Ring up the juice", ["juice_carton_apple scanned"]),
        ("cashier_desk", "Read the barcode of the juice", ["juice_carton_apple scanned"]),
        ("cashier_desk", "Turn the payment sign to the customer", ["payment_sign_blue presented"]),
        ("cashier_desk", "Weigh a citrus fruit", ["lemon_ripe weighed"]),
        ("cabinet", "Show the cookie box's bar code to the customer", ["cookie_box_cream presented"]),
        ("cabinet", "Pass the lock from the left arm to the right arm", ["padlock_brass handed right"]),
        ("cabinet", "Pass the lock from your left hand to your right", ["padlock_brass handed right"]),
        ("cabinet", "Put the tea near the red first aid kit", ["tea_box_green near first_aid_kit_red"]),
        ("kitchen", "Get the water running", ["tap_chrome/lever turned"]),
        ("kitchen", "Can the banana go in the pot?", ["banana_ripe inside pot_steel"]),
        ("cashier_desk", "Show the QR code to the customer", ["payment_sign_blue presented"]),
        ("office_desk", "Pass the red pen to your left hand", ["marker_red handed left"]),
        ("office_desk", "Put the stapler on the cabinet", ["stapler_black on cabinet_two_drawers_walnut"]),
        ("cabinet", "Put the lock on top of the cupboard", ["padlock_brass on hinged_cabinet_white"]),
        ("bathroom", "Put the soap dish back", ["soap_dish_white back"]),
        ("bathroom", "olive soap on the soap dish", ["soap_bar_olive inside soap_dish_white"]),
    ],
)
def test_words_become_goals_of_the_closed_vocabulary(scene: str, instruction: str, expected: list[str]) -> None:
    assert goals(scene, instruction) == expected


@pytest.mark.parametrize(
    ("instruction", "subjects"),
    [
        ("Put the blocks in the box", {"block_red", "block_blue", "block_green", "block_yellow"}),
        ("Put all the blocks except the red one in the box", {"block_blue", "block_green", "block_yellow"}),
        ("Put every block that isn't red in the box", {"block_blue", "block_green", "block_yellow"}),
        ("Put the red and the blue block in the box", {"block_red", "block_blue"}),
        ("Put everything blue in the box", {"marker_blue", "whiteboard_eraser_blue", "tape_roll_blue", "block_blue"}),
    ],
)  # fmt: skip
def test_it_is_told_which_of_several_are_meant(instruction: str, subjects: set[str]) -> None:
    assert {asked.goal.subject for asked in reading("office_desk", instruction).goals} == subjects


def test_a_number_takes_as_many_and_the_other_takes_another() -> None:
    assert len({a.goal.subject for a in reading("office_desk", "Put two of the pens in the box").goals}) == 2
    one, other = reading("kitchen", "One apple goes in the pot, the other one in the pan").goals
    assert {one.goal.subject, other.goal.subject} == {"apple_red", "apple_green"}


def test_the_tower_has_each_on_the_one_before() -> None:
    found = goals("office_desk", "Stack the red, green and blue blocks")
    assert found == ["block_green on block_red", "block_blue on block_green"]


def test_but_first_comes_first() -> None:
    found = reading("cashier_desk", "Put the energy drink in the basket, but scan it first").goals
    assert [a.goal.relation for a in sorted(found, key=lambda a: a.step)] == ["scanned", "inside"]


def test_before_that_comes_before_what_the_last_sentence_asks_for() -> None:
    found = reading("office_desk", "Open the top drawer. Before that, put the stapler in the box.").goals
    assert [a.goal.relation for a in sorted(found, key=lambda a: a.step)] == ["inside", "open"]


def test_a_passive_goes_on_with_the_same_thing() -> None:
    found = goals("cashier_desk", "The lemon should be weighed and then put in the basket")
    assert found == ["lemon_ripe weighed", "lemon_ripe inside shopping_basket_red"]


def test_a_pronoun_may_be_left_out_after_what_was_weighed() -> None:
    found = goals("cashier_desk", "Weigh the lemon and put in the basket")
    assert found == ["lemon_ripe weighed", "lemon_ripe inside shopping_basket_red"]


@pytest.mark.parametrize(
    "instruction",
    [
        "How heavy is the lemon? Weigh it",
        "The customer wants the lemon, so weigh it",
        "Since I like citrus fruit, weigh the lemon",
        "Weigh the lemon so that nobody complains",
        "Sweetheart, weigh the lemon",
    ],
)
def test_questions_and_reasons_beside_a_command_are_passed_by(instruction: str) -> None:
    assert goals("cashier_desk", instruction) == ["lemon_ripe weighed"]


def test_one_thing_on_each_of_several_places() -> None:
    found = goals("kitchen", "Put an apple on each plate")
    assert found == ["apple_red on plate_white", "apple_green on plate_blue"]


def test_two_things_stand_next_to_each_other() -> None:
    assert goals("cashier_desk", "Put the tomatoes next to each other") == ["tomato_red beside tomato_yellow"]


def test_its_left_is_that_of_the_place_named_last() -> None:
    found = goals("office_desk", "Put the mouse behind the laptop and the notepad to its left")
    assert found == ["computer_mouse_white behind laptop_silver", "notepad_yellow left_of laptop_silver"]


def test_the_orange_is_a_fruit_where_no_colour_was_named() -> None:
    found = goals("kitchen", "The bagel goes in the pan and the orange in the pot")
    assert found == ["bagel_sesame inside frying_pan_black", "orange_orange inside pot_steel"]


def test_neither_of_them_is_touched() -> None:
    found = reading("bathroom", "Neither duck should be moved, but the sponge goes in the basket")
    assert found.untouched == ["rubber_duck_yellow", "rubber_duck_pink"]


def test_what_is_already_asked_for_is_not_asked_for_twice() -> None:
    found = goals("bathroom", "The sponge goes in the basket, so put it in there")
    assert found == ["sponge_blue inside basket_grey"]


def test_a_thing_is_named_by_what_it_is_of() -> None:
    assert goals("cashier_desk", "Scan the tin of tomatoes") == ["can_tomato scanned"]


def test_what_shall_be_left_alone_is_told() -> None:
    assert reading("office_desk", "Leave the stapler alone and put the phone on the book").untouched == [
        "stapler_black"
    ]


@pytest.mark.parametrize(
    ("scene", "instruction", "why"),
    [
        ("kitchen", "Put the mug on the plate", "may be mug_white"),
        ("kitchen", "Put the kettle on the blue plate", "no such thing"),
        ("kitchen", "Put the purple apple on the blue plate", "no such thing"),
        ("kitchen", "Put the fresh apple on the blue plate", "no such thing"),
        ("office_desk", "Put the stapler in the fourth drawer", "not there"),
        ("office_desk", "Put the stapler in the middle drawer", "not there"),
        ("office_desk", "Put the book in the box", "cannot pick up"),
        ("office_desk", "Put three of the erasers in the box", "only"),
        ("office_desk", "Scan the stapler", "no barcode scanner"),
        ("office_desk", "Open the stapler", "nothing of it"),
        ("office_desk", "Leave the stapler alone and put the stapler on the book", "left alone and moved"),
        ("cashier_desk", "Put the lemon left of the juice and the juice left of the lemon", "contradicts itself"),
        ("cabinet", "Put the tea in the cupboard", "nothing can be put in"),
        ("cabinet", "Hand me the lock", "to whom"),
        ("office_desk", "Could the stapler be in the box?", "asks for nothing"),
        ("office_desk", "Open the top drawer. Put the stapler in the box before that", "not there"),
        ("cashier_desk", "Ring the bell for the customer", "no use"),
        ("cashier_desk", "He wants the juice, the lemon and the lime scanned", "asks for nothing"),
        ("office_desk", "Put the lid of the box on the book", "its lid is not moved by itself"),
    ],
)
def test_what_leaves_a_doubt_is_refused(scene: str, instruction: str, why: str) -> None:
    with pytest.raises(UnreadInstruction, match=why):
        reading(scene, instruction)


@pytest.mark.parametrize(
    ("instruction", "quoted"),
    [
        ("Put the Dining fork on the blue plate", "fork"),
        ("Put the Redd aples on the blue plate", "Redd aples"),
        ("Put the sink in the Pot", "sink"),
        ("Put the apple on the blue plate, but not the Purple one", "apple"),
    ],
)
def test_what_is_refused_is_quoted_as_it_was_typed(instruction: str, quoted: str) -> None:
    with pytest.raises(UnreadInstruction) as caught:
        reading("kitchen", instruction)
    assert quoted in caught.value.details["unread"] and caught.value.details["unread"] in instruction
