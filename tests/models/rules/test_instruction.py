from __future__ import annotations

import pytest

from vcage.models.rules.instruction import Request, parse_instruction


def moves(instruction: str) -> list[tuple[list[str], str]]:
    """(what is moved, where to) of each request."""
    return [
        ([p.text for p in (*r.contents, *r.again)], r.receptacle.text if r.receptacle else "")
        for r in parse_instruction(instruction)
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
        "Open the box and put the pen and the ruler inside",
        "Into the box go the pen and the ruler",
        "Could you please pop the pen and the ruler into the box?",
    ],
)
def test_many_forms_ask_for_the_same(instruction: str) -> None:
    assert moves(instruction) == [(["pen", "ruler"], "box")]


def test_there_is_the_place_named_before() -> None:
    found = moves("Put the pen into the box, then place the ruler there as well")
    assert found == [(["pen"], "box"), (["ruler"], "box")]


def test_a_thing_that_is_moved_on_is_named_once() -> None:
    first, second = parse_instruction("Weigh two potatoes on the scale and put them in the basket")
    assert [p.text for p in first.contents] == ["potatoes"] and first.contents[0].count == 2
    assert second.contents == () and second.again == first.contents


def test_them_takes_over_all_that_has_no_place_yet() -> None:
    text = "Scan the milk with the scanner, weigh the tomato on the scale and place them on the mat"
    weigh, place = parse_instruction(text)
    assert [p.text for p in weigh.contents] == ["tomato"]
    assert [p.text for p in place.contents] == ["milk"] and place.again == weigh.contents
    assert [p.text for p in place.tools] == ["scanner"]


@pytest.mark.parametrize(
    ("place", "lemmas", "least"),
    [
        ("the drawer", ("drawer",), 1),
        ("the upper drawer", ("drawer",), 2),
        ("the third drawer", ("drawer",), 3),
        ("the top drawer of the cabinet", ("cabinet",), 2),
        ("the drawers of the white cabinet", ("cabinet",), 2),
    ],
)
def test_a_drawer_says_how_many_there_must_be(place: str, lemmas: tuple[str, ...], least: int) -> None:
    found = only(f"Put the pen into {place}").receptacle
    assert (found.part, found.lemmas, found.least_parts) == ("drawer", lemmas, least)


def test_all_drawers_of_an_instruction_are_of_one_cabinet() -> None:
    found = parse_instruction("Put the pen in the first drawer and the ruler in the third drawer")
    assert [r.receptacle.least_parts for r in found] == [3, 3]


def test_its_drawer_is_the_drawer_of_the_place_named_before() -> None:
    _, second = parse_instruction("Put the pen on the small cabinet and put the ruler inside its drawer")
    assert second.receptacle.lemmas == ("small", "cabinet") and second.receptacle.part == "drawer"


@pytest.mark.parametrize(
    ("phrase", "count"),
    [("a pack of batteries", 1), ("two slices of toast", 2), ("slices of toast", None), ("a few apples", 3),
     ("the energy drink", 1), ("the bread", None), ("the three-drawer cabinet", 1), ("both mugs", 2)],
)  # fmt: skip
def test_how_many_things_a_phrase_asks_for(phrase: str, count: int | None) -> None:
    assert only(f"Put {phrase} on the tray").contents[0].count == count


def test_an_instruction_that_only_opens_something_names_it() -> None:
    assert [p.text for p in only("Open the microwave").contents] == ["microwave"]


@pytest.mark.parametrize(
    ("instruction", "contents", "sources", "place"),
    [
        ("Take the eraser out of the pen holder and put it on the plate", ["eraser"], ["pen holder"], "plate"),
        ("Take the apple and the pear off the tray and put them in the box", ["apple", "pear"], ["tray"] * 2, "box"),
        ("Move the mug from the desk to the tray", ["mug"], [], "tray"),
        ("Empty the bowl onto the tray", ["things"], ["bowl"], "tray"),
        ("Empty the basket", ["things"], ["basket"], ""),
    ],
)
def test_what_is_taken_out_of_a_place_starts_there(
    instruction: str, contents: list[str], sources: list[str], place: str
) -> None:
    request = only(instruction)
    assert [p.text for p in request.contents] == contents
    assert [(thing.text, start.text) for thing, start in request.sources] == list(zip(contents, sources, strict=False))
    assert (request.receptacle.text if request.receptacle else "") == place
