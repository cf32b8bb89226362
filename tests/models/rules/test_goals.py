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
    ],
)
def test_what_leaves_a_doubt_is_refused(scene: str, instruction: str, why: str) -> None:
    with pytest.raises(UnreadInstruction, match=why):
        reading(scene, instruction)
