from collections.abc import Callable
from itertools import repeat

import numpy as np
import pytest

from vcage.base.attempts import GaveUp, Refused, first_accepted, least_costly


def drawn_above(limit: float, rng: np.random.Generator) -> Callable[[], float]:
    def propose() -> float:
        number = float(rng.random())
        if number <= limit:
            raise Refused(f"not above {limit}")
        return number

    return propose


def refuse(reason: str) -> Callable[[], float]:
    def propose() -> float:
        raise Refused(reason)

    return propose


def test_first_proposal_that_holds_is_taken_and_refusals_before_it_are_counted():
    found = first_accepted(repeat(drawn_above(0.9, np.random.default_rng(0)), 100))
    numbers = np.random.default_rng(0).random(100)
    assert found.value == numbers[numbers > 0.9][0]
    assert found.reasons == {"not above 0.9": int(np.argmax(numbers > 0.9))}
    assert found.attempts == int(np.argmax(numbers > 0.9)) + 1


def test_giving_up_counts_every_reason_in_order():
    with pytest.raises(GaveUp) as caught:
        first_accepted([refuse("too wide"), refuse("too high"), refuse("too wide")])
    assert caught.value.reasons == {"too wide": 2, "too high": 1}
    assert [str(refusal) for refusal in caught.value.refusals] == ["too wide", "too high", "too wide"]


def test_refusals_in_the_same_words_end_a_search_that_asks_for_that():
    asked = [*map(refuse, ("too wide", "too high", "too high")), lambda: 1.0]
    assert first_accepted(asked).value == 1.0 and first_accepted(asked, same=3).value == 1.0
    with pytest.raises(GaveUp) as error:
        first_accepted(asked, same=2)
    assert error.value.reasons == {"too wide": 1, "too high": 2}


def test_other_exceptions_end_the_search():
    def broken() -> float:
        raise KeyError("a bug")

    with pytest.raises(KeyError, match="a bug"):
        first_accepted([broken, lambda: 1.0])


def test_no_proposals_give_up():
    with pytest.raises(GaveUp):
        first_accepted([])


def test_least_costly_stops_at_the_first_that_is_good_enough():
    drawn = []

    def draw():
        for number in (3, 1, 0):
            drawn.append(number)
            yield number

    assert least_costly(draw(), cost=lambda number: number, enough=1) == 1
    assert drawn == [3, 1]


def test_least_costly_takes_the_first_of_equals():
    assert least_costly(["bb", "a", "c"], cost=len) == "a"
