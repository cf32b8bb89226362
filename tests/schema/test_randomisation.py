"""Ranges that make no sense are refused by their field."""

import pytest
from pydantic import ValidationError

from vcage.schema.randomisation import LookRanges, WorldDraw, WorldRanges


@pytest.mark.parametrize(
    ("field", "value"),
    [("clutter", (0, 11)), ("table_height", (-0.5, 0.0)), ("mass", (0.0, 1.0)), ("start", 1.0), ("friction", (2, 1))],
)
def test_what_a_world_cannot_have_is_refused(field, value):
    with pytest.raises(ValidationError, match=field):
        WorldRanges.model_validate({field: value})


@pytest.mark.parametrize(
    "ranges",
    [
        {"light": {"number": (1, 4)}},
        {"light": {"number": (0, 1)}},
        {"light": {"shadows": 2}},
        {"cameras": {"fovy": (1.0, 9.0)}},
        {"cameras": {"shift": -0.1}},
        {"colours": {"hue_deg": 400}},
    ],
)
def test_what_a_look_cannot_have_is_refused(ranges):
    (part, fields), *_ = ranges.items()
    with pytest.raises(ValidationError, match=rf"{part}\.{next(iter(fields))}"):
        LookRanges.model_validate(ranges)


def test_a_line_tells_what_differs_and_what_there_is_no_room_for():
    world = WorldDraw(clutter={"cup": "cup"}, clutter_drawn=3, table_height=-0.02)
    assert world.told == "1 objects beside of 3, table -2 cm"
    assert WorldDraw().told == ""
