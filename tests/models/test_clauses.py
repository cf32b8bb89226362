"""Which words belong together, and which come first."""

from __future__ import annotations

from vcage.models.clauses import ordered, paired


def test_places_follow_their_things_or_lead_them() -> None:
    assert paired({0: ["a"], 4: ["b"]}, {2: "x", 6: "y"}) == {"a": "x", "b": "y"}
    assert paired({2: ["a"], 6: ["b"]}, {0: "x", 4: "y"}) == {"a": "x", "b": "y"}
    assert paired({0: ["a"], 1: ["b", "c"], 4: ["d"]}, {3: "x", 6: "y"}) == {"a": "x", "b": "x", "c": "x", "d": "y"}


def test_where_one_place_too_many_is_named_nothing_is_paired() -> None:
    assert paired({0: ["a"], 6: ["b"]}, {2: "x", 4: "y", 8: "z"}) == {}
    assert paired({2: ["a"], 4: ["b"]}, {0: "x", 6: "y", 8: "z"}) == {}


def test_an_object_with_two_places_has_none() -> None:
    assert paired({0: ["a"], 4: ["a"]}, {2: "x", 6: "y"}) == {}


def first_and_then(text: str) -> list[tuple[str, str]]:
    words = text.split()
    return [(" ".join(words[slice(*a)]), " ".join(words[slice(*b)])) for a, b in ordered(words)]


def test_words_of_time_order_the_goals_around_them() -> None:
    assert first_and_then("one then two") == [("one", "then two")]
    assert first_and_then("please do the one before two") == [("please do the one", "before two")]
    assert first_and_then("please do the two after one") == [("after one", "please do the two")]
    assert first_and_then("after one , do two") == [("after one", ", do two")]
    assert first_and_then("before two , do one") == [(", do one", "before two")]
    assert first_and_then("do two but first one") == [("but first one", "do two")]
