from __future__ import annotations

import pytest

from vcage.models.rules.pairs import judge_object_and_place
from vcage.schema.subtasks import PairAnswer, PairQuestion


def ask(
    thing: str, place: str, holds: str, size: tuple = (0.05, 0.05, 0.05), opening: tuple = (0.2, 0.2, 0.1)
) -> PairAnswer:
    question = PairQuestion(
        object="a", object_words=thing, receptacle="b", receptacle_words=place, holds=holds, object_size=size,
        opening_size=opening,
    )  # fmt: skip
    return judge_object_and_place(question)


@pytest.mark.parametrize(
    ("thing", "place", "holds"),
    [
        ("black marker pen", "packaging box", "in"),
        ("red block", "white plate", "on"),
        ("bread roll", "bread box", "in"),
        ("marker pen: a fat one", "mug", "in"),
        ("stapler", "top drawer of the white cabinet", "in"),
    ],
)
def test_ordinary_human_actions_are_sensible(thing: str, place: str, holds: str) -> None:
    assert ask(thing, place, holds).sensible


@pytest.mark.parametrize(
    ("thing", "place", "holds"),
    [
        ("bagel", "stapler", "on"),
        ("packaging box", "mug", "in"),
        ("croissant", "book", "on"),
        ("stapler", "bread box", "in"),
        ("plate", "red block", "on"),
    ],
)
def test_senseless_pairs_get_a_reason(thing: str, place: str, holds: str) -> None:
    answer = ask(thing, place, holds)
    assert not answer.sensible and answer.reason


def test_an_object_too_large_for_the_opening_is_refused_with_both_sizes() -> None:
    answer = ask("book", "packaging box", "in", size=(0.3, 0.2, 0.03), opening=(0.24, 0.17, 0.07))
    assert not answer.sensible and "30.0 x 20.0 cm" in answer.reason and "24.0 x 17.0 cm" in answer.reason
