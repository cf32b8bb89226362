"""Words that are easily passed by, each of which changes what is asked for."""

from __future__ import annotations

import pytest

from benchmarks.instructions import load_scenes
from vcage.base.errors import UnreadInstruction
from vcage.models.rules.goals import read_goals
from vcage.plans.actions import lasting
from vcage.schema.goals import in_steps

SCENES = load_scenes()
OAK, WALNUT = "cabinet_three_drawers_oak/drawer_", "cabinet_two_drawers_walnut/drawer_"
LEFT_OPEN = [f"{WALNUT}top open", f"stapler_black inside {WALNUT}top"]
BOWL, BASKET = "inside bowl_white", "inside shopping_basket_red"


def goals(scene: str, instruction: str) -> list[str]:
    """The goals by step."""
    return [str(asked.goal) for asked in sorted(read_goals(instruction, SCENES[scene]).goals, key=lambda a: a.step)]


def refuses(scene: str, instruction: str, why: str | None = None) -> None:
    with pytest.raises(UnreadInstruction, match=why):
        read_goals(instruction, SCENES[scene])


@pytest.mark.parametrize(
    "instruction",
    [
        "Put the stapler in the top drawer, but do not close it",
        "Put the stapler in the top drawer and don't shut it.",
        "Put the stapler in the top drawer. Don't close the drawer.",
        "Put the stapler in the top drawer and never close it",
        "Put the stapler in the top drawer without closing it",
        "Put the stapler in the top drawer and leave it open",
        "Put the stapler in the top drawer and keep the drawer open",
        "Put the stapler in the top drawer and make sure it stays open",
        "Open the top drawer, put the stapler in it and leave it open",
    ],
)
def test_what_shall_not_be_closed_is_open_at_the_end(instruction: str) -> None:
    assert goals("office_desk", instruction) == LEFT_OPEN
    found = lasting(in_steps(read_goals(instruction, SCENES["office_desk"]).goals))
    assert f"{WALNUT}top open" in map(str, found)


def test_a_box_that_shall_not_be_closed_is_opened_by_its_lid() -> None:
    found = goals("office_desk", "Put the stapler in the walnut box, but don't close it")
    assert found == ["lidded_box_walnut/lid open", "stapler_black inside lidded_box_walnut"]


def test_of_two_drawers_both_are_left_open() -> None:
    found = goals("office_desk", "Put the stapler in the top drawer, the tape in the bottom drawer and leave both open")
    assert set(found) == {*LEFT_OPEN, f"{WALNUT}bottom open", f"tape_roll_blue inside {WALNUT}bottom"}
    assert found[:2] == [f"{WALNUT}top open", f"{WALNUT}bottom open"]


@pytest.mark.parametrize(
    ("scene", "instruction"),
    [
        ("cashier_desk", "Open the cash drawer and keep it closed"),
        ("cabinet", "Don't open the top drawer, put the padlock in it"),
        ("kitchen", "Put the red apple in the white bowl and leave the red apple on the table"),
    ],
)
def test_what_contradicts_itself_is_refused(scene: str, instruction: str) -> None:
    refuses(scene, instruction, "contradicts")


@pytest.mark.parametrize(
    "instruction",
    [
        "Put the lime in the basket with the right arm",
        "Take the lime with the left arm and put it in the basket",
        "Take the lime in your right hand and put it in the basket",
        "Pass the lime from the left hand to the left hand",
        "Give the lime to the customer with the left hand",
        "Put the lime in the basket with the right arm, then pass the lemon to the left hand",
    ],
)
def test_an_arm_that_no_goal_can_name_is_refused(instruction: str) -> None:
    refuses("cashier_desk", instruction, "which arm")


def test_from_one_arm_to_the_other_is_a_goal() -> None:
    assert goals("cashier_desk", "Take the lime with the left arm and pass it to the right arm") == [
        "lime_green handed right"
    ]


def test_what_stands_before_a_colon_must_be_of_use() -> None:
    refuses("cashier_desk", "Left arm: put the lime in the basket", "nothing is asked for with it")


@pytest.mark.parametrize("instruction", ["No stapler in the tray!", "No pens in the tray, please."])
def test_no_before_a_thing_forbids_it(instruction: str) -> None:
    refuses("office_desk", instruction, "shall not be put")


@pytest.mark.parametrize(
    ("instruction", "untouched"),
    [
        ("Padlock in the basket, no screwdrivers.", ["screwdriver_red", "screwdriver_blue"]),
        ("Put the padlock in the basket, no tape.", ["tape_measure_yellow"]),
        ("Put the padlock in the basket. No tape.", ["tape_measure_yellow"]),
    ],
)
def test_no_without_an_article_corrects_nothing(instruction: str, untouched: list[str]) -> None:
    found = read_goals(instruction, SCENES["cabinet"])
    assert ([str(a.goal) for a in found.goals], found.untouched) == (["padlock_brass inside basket_natural"], untouched)


def test_no_with_an_article_corrects() -> None:
    assert goals("cabinet", "Put the padlock in the basket, no, the tape measure") == [
        "tape_measure_yellow inside basket_natural"
    ]
    refuses("cabinet", "Put the padlock, no tape measure, in the basket")


@pytest.mark.parametrize("others", ["the others", "the rest", "the other two", "the other drawers", "all the others"])
def test_the_others_are_not_the_one_named_before(others: str) -> None:
    found = goals("cabinet", f"Open the top drawer and close {others}")
    assert found == [f"{OAK}top open", f"{OAK}middle closed", f"{OAK}bottom closed"]


def test_the_other_things_are_not_what_something_was_put_on() -> None:
    found = goals("office_desk", "Put the red block on the blue block and the other blocks in the tray")
    assert found[1:] == ["block_green inside document_tray_black", "block_yellow inside document_tray_black"]


@pytest.mark.parametrize(
    ("which", "parts"),
    [
        ("third drawer from the bottom", ["top"]),
        ("first drawer from the bottom", ["bottom"]),
        ("second drawer from the top", ["middle"]),
        ("second lowest drawer", ["middle"]),
        ("second highest drawer", ["middle"]),
        ("last drawer", ["bottom"]),
        ("top two drawers", ["top", "middle"]),
        ("lower two drawers", ["middle", "bottom"]),
        ("top and bottom drawers", ["top", "bottom"]),
    ],
)
def test_drawers_are_counted_from_the_end_that_is_named(which: str, parts: list[str]) -> None:
    assert goals("cabinet", f"Open the {which}") == [f"{OAK}{part} open" for part in parts]


@pytest.mark.parametrize(
    "which",
    ["lower drawers", "fourth drawer from the bottom", "third drawer up", "four top drawers", "top second drawer"],
)
def test_drawers_that_cannot_be_counted_are_refused(which: str) -> None:
    refuses("cabinet", f"Open the {which}")


def test_one_thing_does_not_go_into_two_drawers() -> None:
    refuses("cabinet", "Put the padlock in the top two drawers", "one by one")


@pytest.mark.parametrize(
    "instruction",
    [
        "Close the top drawer once the stapler is in it",
        "Close the top drawer when the stapler is in it",
        "Close the top drawer after the stapler is in it",
        "Put the stapler in the top drawer and close it once the stapler is in it",
    ],
)
def test_once_it_is_there_asks_for_what_was_not_asked_for_yet(instruction: str) -> None:
    assert goals("office_desk", instruction) == [f"stapler_black inside {WALNUT}top", f"{WALNUT}top closed"]


@pytest.mark.parametrize(
    "instruction",
    [
        "Put the padlock in the top drawer, the tape measure in the bottom drawer and close both",
        "Put the padlock in the top drawer, the tape measure in the bottom drawer and close them",
        "Move the padlock from the top drawer to the bottom drawer and close both",
        "Open the top drawer, put the padlock in the bottom drawer and close both",
    ],
)
def test_both_are_the_drawers_that_were_used(instruction: str) -> None:
    assert goals("cabinet", instruction)[-2:] == [f"{OAK}top closed", f"{OAK}bottom closed"]


@pytest.mark.parametrize(
    ("scene", "instruction"),
    [
        ("cabinet", "Put the padlock in the top drawer and close both"),
        ("cabinet", "Open the top drawer, the middle drawer and the bottom drawer, then close both"),
        ("cabinet", "Take the padlock, the tape measure and the battery pack and put both in the basket"),
        ("cabinet", "Take the padlock and the tape measure and put all three in the basket"),
    ],
)
def test_both_are_two(scene: str, instruction: str) -> None:
    refuses(scene, instruction, "not clear what these are")


@pytest.mark.parametrize("place", ["top drawer", "walnut box"])
def test_it_may_be_what_was_opened_or_what_was_filled(place: str) -> None:
    refuses("office_desk", f"Open the laptop, put the stapler in the {place} and close it", "more than one thing")


@pytest.mark.parametrize(
    ("instruction", "goal"),
    [
        ("Put the chocolate bar in front of the scanner", "chocolate_bar_milk in_front_of barcode_scanner_black"),
        ("Put the chocolate bar by the scanner", "chocolate_bar_milk beside barcode_scanner_black"),
        ("Hold the chocolate bar in front of the scanner", "chocolate_bar_milk scanned"),
        ("Move the chocolate bar past the scanner", "chocolate_bar_milk scanned"),
    ],
)
def test_what_is_put_by_the_scanner_is_not_scanned(instruction: str, goal: str) -> None:
    assert goals("cashier_desk", instruction) == [goal]


def test_nothing_is_put_under_the_scanner() -> None:
    refuses("cashier_desk", "Put the chocolate bar under the scanner", "puts nothing there")


@pytest.mark.parametrize(
    "instruction",
    [
        "Put the banana in the white bowl, actually the orange too",
        "Put the banana in the white bowl. Actually, the orange too.",
        "Put the banana in the white bowl, sorry, and the orange",
        "Put the banana in the white bowl, hmm, and the orange",
        "Put the banana, sorry, and the orange in the white bowl",
        "Put the banana in the white bowl. Actually, put the orange in it as well.",
    ],
)
def test_too_and_and_add_to_what_was_said(instruction: str) -> None:
    assert goals("kitchen", instruction) == [f"banana_ripe {BOWL}", f"orange_orange {BOWL}"]


@pytest.mark.parametrize("more", [", actually the lemon too", ". Oh wait, the lemon too.", ", sorry, and the lemon"])
def test_what_is_scanned_too_is_scanned_besides(more: str) -> None:
    assert goals("cashier_desk", f"Scan the lime{more}") == ["lime_green scanned", "lemon_ripe scanned"]


@pytest.mark.parametrize(
    ("instruction", "why"),
    [
        ("Scan the lime, no, the lemon and the potato too", "besides is not clear"),
        ("Scan the lime and the lemon, then weigh it", "more than one thing"),
    ],
)
def test_what_may_add_or_take_back_and_what_it_may_be_is_refused(instruction: str, why: str) -> None:
    refuses("cashier_desk", instruction, why)


def test_what_is_done_too_in_another_clause_adds_nothing_to_this_one() -> None:
    found = goals("cashier_desk", "Put the lime in the basket, no, the lemon, and ring the bell too")
    assert found == [f"lemon_ripe {BASKET}", "service_bell_silver/button pressed"]


def test_a_drawer_is_opened_too() -> None:
    found = goals("cabinet", "Open the top drawer, actually the bottom one too")
    assert found == [f"{OAK}top open", f"{OAK}bottom open"]


def test_the_orange_and_the_carrot_are_two_things() -> None:
    found = goals("kitchen", "Put the banana, I mean the orange, and the carrot in the white bowl")
    assert found == [f"orange_orange {BOWL}", f"carrot_orange {BOWL}"]


@pytest.mark.parametrize(
    "again", [". Do the same with the lemon.", ", then the lemon", ". The same goes for the lemon."]
)
def test_the_same_again_is_all_of_it(again: str) -> None:
    found = goals("cashier_desk", f"Scan the lime and put it in the basket{again}")
    done = [f"{thing} {what}" for thing in ("lime_green", "lemon_ripe") for what in ("scanned", BASKET)]
    assert found == done


def test_a_drawer_is_opened_and_closed_like_the_one_before() -> None:
    found = goals("cabinet", "Open the bottom drawer and close it, then do the same with the top drawer")
    assert found == [f"{OAK}{part} {word}" for part in ("bottom", "top") for word in ("open", "closed")]


@pytest.mark.parametrize(
    ("scene", "instruction"),
    [
        ("cabinet", "Open the bottom drawer, put the padlock in it, close it, then do the same with the top drawer"),
        ("cashier_desk", "Weigh the lime, then put the lemon in the basket. Do the same with the potato."),
    ],
)
def test_the_same_again_is_refused_where_it_may_be_more_or_less(scene: str, instruction: str) -> None:
    refuses(scene, instruction, "done again")


@pytest.mark.parametrize("what", ["the tomatoes together", "the lemon together with the lime"])
def test_things_are_not_weighed_together(what: str) -> None:
    refuses("cashier_desk", f"Weigh {what}", "one thing at a time")


@pytest.mark.parametrize("things", ["writing things", "paper things", "small things", "round things", "office things"])
def test_things_of_a_sort_are_not_those_that_are_described_by_the_word(things: str) -> None:
    refuses("office_desk", f"Put the {things} in the tray", "no such thing")


def test_things_of_a_colour_are_known() -> None:
    assert len(goals("office_desk", "Put the blue things in the tray")) == 4


def test_a_short_name_that_another_thing_may_have_is_refused() -> None:
    refuses("office_desk", "Put the eraser in the tray", "may be")
    assert len(goals("office_desk", "Put both erasers in the tray")) == 2


@pytest.mark.parametrize("where", ["in the front of", "at the back of", "toward", "besides"])
def test_words_for_a_place_that_is_none_of_the_goals_are_refused(where: str) -> None:
    refuses("kitchen", f"Put the banana {where} the bread box")


@pytest.mark.parametrize(
    ("scene", "instruction"),
    [
        ("kitchen", "Put the fruit besides the red apple in the white bowl"),
        ("cashier_desk", "Hand the customer the juice and me the lemon"),
        ("cashier_desk", "Give the customer the lime and then me the lemon"),
        ("office_desk", "Ring the bell, then again"),
        ("cabinet", "Take the padlock from the bench and put it in the basket"),
        ("office_desk", "Put the stapler in the top drawer and leave the drawer alone"),
    ],
)
def test_a_word_that_says_more_is_not_passed_by(scene: str, instruction: str) -> None:
    refuses(scene, instruction)
