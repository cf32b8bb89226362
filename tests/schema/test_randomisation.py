"""Ranges that make no sense are refused by their field."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from vcage.schema.randomisation import HEIGHT_STEP, Look, LookRanges, WorldDraw, WorldRanges, heights_within


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("clutter", (0, 11)),
        ("table_height", (-0.5, 0.0)),
        ("table_height", (0.006, 0.007)),
        ("mass", (0.0, 1.0)),
        ("mass", (0.001, 1.0)),
        ("start", 1.0),
        ("friction", (2, 1)),
    ],
)
def test_impossible_values_of_a_world_are_refused(field, value):
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
        {"cameras": {"turn_deg": 5000}},
        {"light": {"strength": (-2, -1)}},
        {"light": {"warmth": (3, 3)}},
        {"light": {"heading_deg": (-1e308, 1e308)}},
        {"surfaces": {"wall_tone": (1e308, 1e308)}},
        {"surfaces": {"floor_tone": (0.5, 1.5)}},
        {"surfaces": {"tint": (0.01, 1)}},
        {"colours": {"hue_deg": 400}},
        {"colours": {"saturation": (1, 11)}},
        {"colours": {"lightness": (1e300, 1e300)}},
    ],
)
def test_impossible_values_of_a_look_are_refused(ranges):
    (part, fields), *_ = ranges.items()
    with pytest.raises(ValidationError, match=rf"{part}\.{next(iter(fields))}"):
        LookRanges.model_validate(ranges)


@given(st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1)).map(sorted))
def test_the_heights_of_a_range_are_within_it(ends):
    lowest, highest = heights_within((ends[0], ends[1]))
    assert all(ends[0] - 1e-7 <= HEIGHT_STEP * k <= ends[1] + 1e-7 for k in range(lowest, highest + 1))


def test_a_look_describes_table_wall_and_floor():
    with pytest.raises(ValidationError, match="nothing is said of floor, wall"):
        Look.model_validate(
            {
                "lights": [{"direction": (0, 0, -1), "colour": (1, 1, 1), "shadows": True}],
                "ambient": (0.4, 0.4, 0.4),
                "surfaces": {"table": {"texture": "oak", "colour": (1, 1, 1)}},
            }
        )


def test_a_line_names_the_differences_and_the_omitted_count():
    world = WorldDraw(clutter={"cup": "cup"}, clutter_drawn=3, table_height=-0.02)
    assert world.summary == "1 objects beside of 3, table -2 cm"
    assert WorldDraw().summary == ""
