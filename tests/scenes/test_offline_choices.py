"""Sentences that are read without a model, with the second look at what was read."""

from __future__ import annotations

import numpy as np
import pytest

from vcage.runs.context import StageContext
from vcage.scenes.chosen_objects import choose
from vcage.sim.robots import load_template


def goals(sentence: str) -> list[str]:
    """The goals of a sentence on the plain table, in plain words."""
    chosen = choose(sentence, load_template("table", None), StageContext("offline"), np.random.default_rng(0))
    assert chosen.reading is not None
    return [str(asked.goal) for asked in chosen.reading.goals]


@pytest.mark.parametrize(
    ("things", "counts"),
    [
        ("two red and three blue blocks", {"red": 2, "blue": 3}),
        ("one red, two blue and one green block", {"red": 1, "blue": 2, "green": 1}),
        ("a red and two blue blocks", {"red": 1, "blue": 2}),
        ("two red blocks and three blue ones", {"red": 2, "blue": 3}),
    ],
)
def test_colours_with_a_number_each_share_the_noun_at_their_end(things: str, counts: dict[str, int]) -> None:
    found = [goal.split("_")[1].split(" ")[0] for goal in goals(f"Put {things} in the box")]
    assert {colour: found.count(colour) for colour in found} == counts


@pytest.mark.parametrize(("thing", "done"), [("drawer", "closed"), ("button", "pressed"), ("peg", "inserted_in")])
def test_the_second_look_knows_what_is_pressed_in(thing: str, done: str) -> None:
    (found,) = goals(f"Press the {thing} in")
    assert done in found


@pytest.mark.parametrize("contents", ["everything in", "everything out of", "all that is in"])
def test_everything_in_a_vessel_is_poured_with_it(contents: str) -> None:
    (found,) = goals(f"Pour {contents} the cup into the bowl")
    assert found.startswith("cup_") and " poured bowl_" in found


def test_what_is_said_to_have_fallen_over_is_stood_up() -> None:
    (found,) = goals("A bottle has fallen over. Stand it up")
    assert found.startswith("bottle_") and found.endswith(" upright")
