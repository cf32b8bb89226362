"""Sides, arms and drawers that a text names, by the place of their words."""

from __future__ import annotations

import pytest

from vcage.models.checked_reading import plain_sides
from vcage.models.directions import arms, heights, sides

THREE = ("drawer_bottom", "drawer_middle", "drawer_top")
TWO = ("drawer_bottom", "drawer_top")


@pytest.mark.parametrize(
    ("text", "parts", "found"),
    [
        ("the second drawer from the top", THREE, "middle"),
        ("the second drawer from the top", TWO, "bottom"),
        ("the drawer second from the bottom", TWO, "top"),
        ("the third drawer down", THREE, "bottom"),
        ("the lowest of the three drawers", THREE, "bottom"),
        ("the upper drawer", TWO, "top"),
        ("the drawer at the bottom", THREE, "bottom"),
        ("the one in the middle", THREE, "middle"),
    ],
)
def test_drawers_are_counted_from_the_named_end(text: str, parts: tuple[str, ...], found: str) -> None:
    assert list(heights(text, parts).values()) == [found]


def test_a_third_drawer_of_two_is_none() -> None:
    assert heights("the third drawer from the top", TWO) == {}


def test_a_side_may_follow_its_object() -> None:
    assert plain_sides("on the plate's left") == "on the left of the plate"
    assert plain_sides("with the robot's left arm") == "with the robot's left arm"


def test_sides_and_arms_are_told_apart() -> None:
    text = "put it left of the plate with the right arm"
    assert list(sides(text).values()) == ["left_of"] and list(arms(text).values()) == ["right"]
    assert arms("on the left hand side of the plate") == {}
