from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vcage.models.rules.instruction import parse_instruction
from vcage.models.rules.words import is_plural, lemma


@pytest.mark.parametrize(
    ("plural", "singular"),
    [
        ("boxes", "box"),
        ("loaves", "loaf"),
        ("berries", "berry"),
        ("mugs", "mug"),
        ("dishes", "dish"),
        ("glass", "glass"),
    ],
)
def test_lemmas_are_singular(plural: str, singular: str) -> None:
    assert lemma(plural) == singular


@pytest.mark.parametrize("word", ["scissors", "chess", "bus", "box"])
def test_what_only_ends_like_a_plural_is_none(word: str) -> None:
    assert not is_plural(word)


def test_one_instruction_may_hold_several_clauses() -> None:
    text = "Please put two apples in the bowl and the stapler into the box, then move the red block onto the plate."
    found = [(r.contents[0].text, r.contents[0].count, r.receptacle.text) for r in parse_instruction(text)]
    assert found == [("apples", 2, "bowl"), ("stapler", 1, "box"), ("red block", 1, "plate")]


def test_a_bare_colour_takes_the_head_of_the_next_phrase() -> None:
    contents = parse_instruction("Put the red, green and blue blocks on the plate")[0].contents
    assert [(p.colour, p.head, p.count) for p in contents] == [(c, "block", 1) for c in ("red", "green", "blue")]


def test_a_colour_word_that_is_the_noun_stays_a_noun() -> None:
    assert parse_instruction("Put the orange in the bowl")[0].contents[0].head == "orange"


WORDS = "put fill empty open pull the it two red of in into from with using and then there its drawer pens : , . - é 7"


@settings(max_examples=60)
@given(st.lists(st.sampled_from(WORDS.split()) | st.text(max_size=6), max_size=24).map(" ".join))
def test_any_text_can_be_parsed(text: str) -> None:
    parse_instruction(text)
