from __future__ import annotations

import pytest

from tests.models.catalogue import CATALOGUE, KITCHEN, entry
from vcage.models.rules.chain import compose_chain
from vcage.schema.asset import CatalogueEntry
from vcage.schema.subtasks import ChainOption

KINDS = {
    kind.words.name: kind for kind in (*CATALOGUE, entry("bread_roll", "bread roll", "food", ("golden",), KITCHEN))
}


def kind_of(phrase: str) -> CatalogueEntry:
    """The kind that a phrase like 'black marker pen' names, in that colour only."""
    if phrase in KINDS:
        return KINDS[phrase]
    colour, _, name = phrase.partition(" ")
    return KINDS[name].model_copy(update={"variants": [v for v in KINDS[name].variants if v.colour == colour]})


def option(name: str, thing: str, place: str) -> ChainOption:
    return ChainOption(
        id=name,
        text=f"Put the {thing} into the {place}.",
        object=thing.replace(" ", "_"),
        receptacle=place.replace(" ", "_"),
        object_kind=kind_of(thing),
        receptacle_kind=kind_of(place),
    )


OPTIONS = [
    option("eraser-box", "whiteboard eraser", "packaging box"),
    option("black-box", "black marker pen", "packaging box"),
    option("black-mug", "black marker pen", "white mug"),
    option("red-box", "red marker pen", "packaging box"),
    option("croissant-bread", "croissant", "bread box"),
    option("roll-bread", "bread roll", "bread box"),
]


@pytest.mark.parametrize(
    ("instruction", "chain"),
    [
        ("Pack the marker pens and the eraser into the box", ["black-box", "red-box", "eraser-box"]),
        ("Put the bread into the bread box", ["croissant-bread", "roll-bread"]),
        ("Put the red marker into the box", ["red-box"]),
        ("Put three markers into the box", []),
        ("Put the eraser in the mug", []),
    ],
)
def test_a_chain_fulfils_the_whole_instruction_or_nothing(instruction: str, chain: list[str]) -> None:
    assert compose_chain(instruction, OPTIONS) == chain


def test_a_thing_that_is_moved_twice_goes_to_its_last_place() -> None:
    options = [option("roll-box", "bread roll", "packaging box"), option("roll-bread", "bread roll", "bread box")]
    text = "Put the bread roll into the packaging box and then put it into the bread box"
    assert compose_chain(text, options) == ["roll-bread"]


def test_a_place_that_is_passed_by_is_not_left_out_in_silence(caplog: pytest.LogCaptureFixture) -> None:
    options = [option("roll-box", "bread roll", "packaging box"), option("roll-bread", "bread roll", "bread box")]
    compose_chain("Put the bread roll into the packaging box and then put it into the bread box", options)
    assert "'bread roll' goes to 'bread box' at once, not by way of 'packaging box'" in caplog.text


def test_a_later_clause_without_a_place_leaves_things_where_they_went() -> None:
    options = [option("roll-bread", "bread roll", "bread box"), option("roll-box", "bread roll", "packaging box")]
    text = "Put the bread roll into the packaging box and then scan it with the stapler"
    assert compose_chain(text, options) == ["roll-box"]


def test_what_is_named_singly_is_not_used_up_by_the_word_for_its_kind() -> None:
    options = [option("roll", "bread roll", "bread box"), option("bagel", "bagel", "bread box")]
    assert compose_chain("Put the breads and the bread roll into the bread box", options) == ["bagel", "roll"]
