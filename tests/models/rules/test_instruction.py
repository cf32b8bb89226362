from __future__ import annotations

import contextlib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vcage.base.errors import UnreadInstruction
from vcage.models.rules.instruction import Request, parse_instruction


def requests(instruction: str) -> list[tuple[str, list[str], str]]:
    """(what is asked, of which things, where to) of each request."""
    return [
        (r.asked, [p.text for p in r.things], r.place.text if r.place else "") for r in parse_instruction(instruction)
    ]


def only(instruction: str) -> Request:
    (request,) = parse_instruction(instruction)
    return request


@pytest.mark.parametrize(
    "instruction",
    [
        "Take the pen and the ruler and put them into the box",
        "Pick up the pen and the ruler, then put both of them into the box.",
        "Fill the box with the pen and the ruler",
        "The pen and the ruler should go into the box",
        "I would like the pen and the ruler to be put into the box",
        "Make sure that the pen and the ruler end up in the box",
        "Tidy up by putting the pen and the ruler into the box",
        "Clear the desk: put the pen and the ruler into the box",
        "Grab the pen and the ruler: they belong in the box",
        "Into the box go the pen and the ruler",
        "Could you please pop the pen and the ruler into the box?",
        "Put the pen, no, the pencil... sorry, the pen and the ruler in the box",
        "pen and ruler in box pls",
    ],
)
def test_many_forms_ask_for_the_same(instruction: str) -> None:
    assert requests(instruction) == [("put", ["pen", "ruler"], "box")]


def test_a_drawer_is_opened_filled_and_closed_in_this_order() -> None:
    found = requests("Open the top drawer, put the stapler in it and close it")
    assert found == [("open", [], "top drawer"), ("put", ["stapler"], "top drawer"), ("close", [], "top drawer")]
    assert [r.step for r in parse_instruction("Open the top drawer, put the stapler in it and close it")] == [1, 2, 3]


def test_there_is_the_place_named_before() -> None:
    found = requests("Put the pen into the box, then place the ruler there as well")
    assert found == [("put", ["pen"], "box"), ("put", ["ruler"], "box")]


def test_a_thing_that_is_moved_on_is_the_same_thing() -> None:
    first, second = parse_instruction("Weigh two potatoes on the scale and put them in the basket")
    assert [p.text for p in first.things] == ["potatoes"] and first.things[0].count == 2
    assert second.things == first.things


def test_them_takes_over_all_that_has_no_place_yet() -> None:
    text = "Scan the milk with the scanner, weigh the tomato on the scale and place them on the mat"
    scan, weigh, place = parse_instruction(text)
    assert [p.text for p in scan.tools] == ["scanner"]
    assert place.things == (*scan.things, *weigh.things)


@pytest.mark.parametrize(
    ("text", "order"),
    [
        ("Before you close the box, put the pen in the cup", ["put", "close"]),
        ("Put the pen in the cup before closing the box", ["put", "close"]),
        ("After opening the box, put the pen in the cup", ["open", "put"]),
        ("Put the pen in the cup after you have opened the box", ["open", "put"]),
        ("Open the box and, once that is done, put the pen in the cup", ["open", "put"]),
    ],
)
def test_before_and_after_say_the_order_and_not_the_words(text: str, order: list[str]) -> None:
    found = parse_instruction(text)
    assert [r.asked for r in found] == order
    assert found[0].step < found[1].step


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("Ring the bell", ("press", [], "bell")),
        ("Give the bell a ring", ("press", [], "bell")),
        ("Push the button", ("press", [], "button")),
        ("Turn the tap on", ("turn", [], "tap")),
        ("Set the timer", ("turn", [], "timer")),
        ("Pull the drawer open", ("open", [], "drawer")),
        ("Push the drawer shut", ("close", [], "drawer")),
        ("The laptop should be closed", ("close", [], "laptop")),
        ("Weigh the lemon", ("weigh", ["lemon"], "")),
        ("Scan the milk", ("scan", ["milk"], "")),
        ("Hand the customer the milk", ("present", ["milk"], "")),
        ("Show the milk to the customer", ("present", ["milk"], "")),
        ("Pass the pen to your left hand", ("hand", ["pen"], "")),
        ("Stack the blocks", ("tower", ["blocks"], "")),
        ("Put the pen back where it was", ("back", ["pen"], "")),
    ],
)
def test_every_verb_asks_for_its_own(text: str, expected: tuple[str, list[str], str]) -> None:
    assert requests(text)[-1] == expected


@pytest.mark.parametrize(
    ("place", "lemmas", "which", "least"),
    [
        ("the drawer", ("drawer",), (), 1),
        ("the upper drawer", ("drawer",), ("upper",), 2),
        ("the third drawer", ("drawer",), ("third",), 3),
        ("the top drawer of the cabinet", ("cabinet",), ("top",), 2),
        ("the cabinet's top drawer", ("cabinet",), ("top",), 2),
        ("the drawers of the white cabinet", ("cabinet",), (), 2),
        ("the top drawer of the three-drawer cabinet", ("three", "drawer", "cabinet"), ("top",), 3),
        ("the third drawer from the bottom", ("drawer",), ("third", "bottom"), 3),
    ],
)
def test_a_drawer_says_which_and_how_many_there_must_be(
    place: str, lemmas: tuple[str, ...], which: tuple[str, ...], least: int
) -> None:
    found = only(f"Put the pen into {place}").place
    assert found is not None
    assert (found.part, found.lemmas, found.which, found.least_parts) == ("drawer", lemmas, which, least)


def test_all_drawers_of_an_instruction_are_of_one_cabinet() -> None:
    found = parse_instruction("Put the pen in the first drawer and the ruler in the third drawer")
    assert [r.place.least_parts for r in found if r.place] == [3, 3]


def test_its_drawer_is_the_drawer_of_the_place_named_before() -> None:
    _, second = parse_instruction("Put the pen on the small cabinet and put the ruler inside its drawer")
    assert second.place is not None
    assert second.place.lemmas == ("small", "cabinet") and second.place.part == "drawer"


@pytest.mark.parametrize(
    ("phrase", "count"),
    [("a pack of batteries", 1), ("the slice of bread", 1), ("two slices of toast", 2), ("slices of toast", None),
     ("a few apples", 3),
     ("the energy drink", 1), ("the bread", None), ("the three-drawer cabinet", 1), ("both mugs", 2),
     ("two of the three mugs", 2), ("one of the mugs", 1), ("everything red", None), ("twenty-five cups", 25)],
)  # fmt: skip
def test_how_many_things_a_phrase_asks_for(phrase: str, count: int | None) -> None:
    assert only(f"Put {phrase} on the tray").things[0].count == count


@pytest.mark.parametrize(
    ("phrase", "left"),
    [
        ("all the pens except the red one", ["red one"]),
        ("every mug that isn't blue", ["blue mug"]),
        ("all cubes but the yellow one", ["yellow one"]),
        ("the fruit apart from the banana and the pear", ["banana", "pear"]),
    ],
)
def test_an_exception_is_kept_with_what_it_limits(phrase: str, left: list[str]) -> None:
    assert [but.text for but in only(f"Put {phrase} on the tray").things[0].but] == left


def test_what_shall_be_left_alone_is_no_move() -> None:
    found = requests("Leave the mug alone and put the pen in the cup")
    assert found == [("leave", ["mug"], ""), ("put", ["pen"], "cup")]


@pytest.mark.parametrize(
    ("instruction", "things", "sources", "place"),
    [
        ("Take the eraser out of the pen holder and put it on the plate", ["eraser"], ["pen holder"], "plate"),
        ("Take the apple and the pear off the tray and put them in the box", ["apple", "pear"], ["tray"] * 2, "box"),
        ("Move the mug from the desk to the tray", ["mug"], [], "tray"),
        ("Empty the bowl onto the tray", ["things"], ["bowl"], "tray"),
    ],
)
def test_what_is_taken_out_of_a_place_starts_there(
    instruction: str, things: list[str], sources: list[str], place: str
) -> None:
    request = only(instruction)
    assert [p.text for p in request.things] == things
    assert [(thing.text, start.text) for thing, start in request.sources] == list(zip(things, sources, strict=False))
    assert request.place is not None and request.place.text == place


@pytest.mark.parametrize(
    ("instruction", "unread"),
    [
        ("Where is the pen?", "Where is the pen"),
        ("Pick up the pen and put the ruler in the box", "Pick up the pen"),
        ("Put the pen in the box and stir the soup", "stir the soup"),
        ("Put the pen under the box", "under the box"),
        ("Don't touch the mug", "nothing"),
        ("Empty the basket", "Empty the basket"),
        ("", "nothing"),
    ],
)
def test_what_is_of_no_use_is_named(instruction: str, unread: str) -> None:
    with pytest.raises(UnreadInstruction) as caught:
        parse_instruction(instruction)
    assert unread in caught.value.details["unread"]
    assert caught.value.exit_code == 2


def test_what_was_understood_is_told() -> None:
    with pytest.raises(UnreadInstruction) as caught:
        parse_instruction("Put the pen in the box and stir the soup")
    assert caught.value.details["understood"] == ["Put the pen in the box"]


@pytest.mark.parametrize(
    "text", ["put teh appel in the boowl", "pleeease put the apple in the bowl", "Put the appple in the bowl"]
)
def test_slips_of_the_pen_are_mended_by_the_names_that_there_are(text: str) -> None:
    (request,) = parse_instruction(text, ["apple", "bowl"])
    assert request.things[0].lemmas == ("apple",)
    assert request.place is not None and request.place.lemmas == ("bowl",)


def test_a_bare_colour_takes_the_head_of_the_next_phrase() -> None:
    things = only("Put the red, green and blue blocks on the plate").things
    assert [(p.colour, p.head, p.count) for p in things] == [(c, "block", 1) for c in ("red", "green", "blue")]


def test_a_colour_word_that_is_the_noun_stays_a_noun() -> None:
    assert only("Put the orange in the bowl").things[0].head == "orange"


WORDS = (
    "put fill empty open pull the it two red of in into from with using and then there its drawer pens : , . - é 7 no "
    "not before after all but one other both that is to customer back leave stack scan turn on"
)


@settings(max_examples=150, deadline=None)
@given(st.lists(st.sampled_from(WORDS.split()) | st.text(max_size=6), max_size=24).map(" ".join))
def test_any_text_is_read_or_refused(text: str) -> None:
    with contextlib.suppress(UnreadInstruction):
        assert parse_instruction(text)
