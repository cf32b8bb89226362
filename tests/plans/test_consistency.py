"""Goals and starting conditions that cannot be true together."""

from __future__ import annotations

import pytest

from vcage.plans.consistency import inconsistencies, unordered_contradictions
from vcage.schema.goals import AskedGoal, Description, goal_of


def asked(*steps: tuple[str, ...]) -> list[AskedGoal]:
    """Goals such as "mug inside cabinet drawer_top" or "box open - lid", by step."""
    said = [
        (number, [None if word == "-" else word for word in text.split()])
        for number, s in enumerate(steps)
        for text in s
    ]
    return [AskedGoal(goal=goal_of(fields), step=number + 1, words="it") for number, fields in said]


def told(*texts: str) -> list[Description]:
    fields = ("subject", "relation", "reference", "part")
    return [Description(**dict(zip(fields, text.split(), strict=False)), words=text) for text in texts]


@pytest.mark.parametrize(
    ("steps", "starts", "said"),
    [
        (
            [("mug on plate", "mug on table")],
            [],
            "goals of one step contradict each other: mug on plate and mug",
        ),
        ([("box open - lid", "box closed - lid")], [], "goals of one step contradict"),
        ([("a left_of b", "b left_of a")], [], "a circle"),
        ([("a row_left_of b", "b row_left_of a")], [], "a circle"),
        ([("mug inside drawer",), ("mug hung_on rack",)], [], "mug inside drawer and then mug hung_on rack"),
        (
            [("mug hung_on rack",), ("mug on plate",)],
            [],
            "mug hung_on rack and then mug on plate, and nothing more is done",
        ),
        ([("mug hung_on rack",), ("mug shaken",)], [], "mug hung_on rack and then mug shaken"),
        ([("mug hung_on rack",), ("pen beside mug",)], [], "mug hung_on rack and then pen beside mug"),
        ([("peg inserted_in block",), ("pen on peg",)], [], "peg inserted_in block and then pen on peg"),
        ([("mug hung_on rack",), ("pen inside mug",)], [], "mug hung_on rack and then pen inside mug"),
        ([("a held_up", "a on b")], [], "contradict each other: a held_up and a on b"),
        ([("a in_place_of b", "c in_place_of b")], [], "a in_place_of b and c in_place_of b"),
        ([("a in_place_of b", "a in_place_of c")], [], "a in_place_of b and a in_place_of c"),
        ([("a back", "b in_place_of a")], [], "a back and b in_place_of a"),
        ([("a on plate",), ("plate wiped",)], [], "a on plate and then plate wiped"),
        ([("a poured bowl",), ("b poured bowl",)], [], "a poured bowl and b poured bowl, as only what is empty"),
        ([("a poured b",), ("b poured bowl",)], [], "a poured b and b poured bowl, as only what is empty"),
        ([("a on b",), ("b on a",)], [], "the goals contradict each other"),
        ([("a on b",)], ["a left_of table", "a right_of table"], "the start conditions contradict each other"),
        ([("a on b",)], ["a inside c drawer_top", "a inside c drawer_bottom"], "the start conditions contradict"),
    ],
)
def test_contradictory_relations_are_named(steps: list[tuple[str, ...]], starts: list[str], said: str) -> None:
    assert said in inconsistencies(asked(*steps), told(*starts))[0]


def test_what_was_done_before_may_be_held_up_in_the_end() -> None:
    assert inconsistencies(asked(("a on b", "c lifted"), ("a held_up",)), []) == []
    assert inconsistencies(asked(("a held_up",), ("a on b",)), []) == []


def test_a_thing_may_be_put_beside_what_is_inserted() -> None:
    assert inconsistencies(asked(("peg inserted_in block",), ("pen beside peg",)), []) == []


def test_things_may_change_places_in_a_circle() -> None:
    assert inconsistencies(asked(("a in_place_of b", "b in_place_of c", "c in_place_of a")), []) == []


def test_later_steps_may_undo_earlier_ones_and_several_may_stand_in_the_middle() -> None:
    steps = asked(("box open - lid",), ("mug inside box",), ("box closed - lid",))
    assert (
        inconsistencies(steps, told("mug center table", "box center table", "mug left_of box", "mug left_of box")) == []
    )


@pytest.mark.parametrize(
    "steps", [[("plate wiped",), ("a on plate",)], [("a on plate",), ("a on table",), ("plate wiped",)]]
)
def test_what_is_empty_by_then_may_be_wiped(steps: list[tuple[str, ...]]) -> None:
    assert not inconsistencies(asked(*steps), [])


def test_goals_without_an_order_put_a_thing_into_one_place_only() -> None:
    goals = [one.goal for one in asked(("a inside b", "a left_of c", "box open - lid", "box closed - lid"))]
    assert unordered_contradictions(goals) == ["a is to be in two places"]
