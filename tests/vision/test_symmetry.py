from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vcage.vision.symmetry import rotational_symmetry, smallest_turn

ANGLES = st.floats(-10, 10)


def drawn(points: np.ndarray, colour: tuple[int, int, int] = (200, 60, 40)) -> np.ndarray:
    """(200, 200, 4) RGBA of a polygon around the middle."""
    alpha = cv2.fillPoly(np.zeros((200, 200), np.uint8), [np.round(points + 100).astype(np.int32)], 255)
    picture = np.zeros((200, 200, 4), np.uint8)
    picture[..., :3], picture[..., 3] = colour, alpha
    return picture


def polygon(sides: int, radius: float = 70) -> np.ndarray:
    angles = 2 * np.pi * np.arange(sides) / sides
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


BOX = np.array([[-70, -40], [70, -40], [70, 40], [-70, 40]])


def test_a_plate_is_round() -> None:
    assert rotational_symmetry(drawn(polygon(200))) == 0


@pytest.mark.parametrize("sides", [3, 4, 5, 6])
def test_a_plain_polygon_has_as_many_turns_as_sides(sides: int) -> None:
    assert rotational_symmetry(drawn(polygon(sides))) == sides


def test_a_plain_box_has_two_turns() -> None:
    assert rotational_symmetry(drawn(BOX)) == 2


def test_a_box_with_a_print_on_one_end_has_none() -> None:
    picture = drawn(BOX)
    picture[80:120, 120:155, :3] = (240, 240, 240)
    assert rotational_symmetry(picture) == 1


def test_a_mug_with_a_handle_has_none() -> None:
    picture = drawn(polygon(200, 50))
    picture[92:108, 140:185] = (200, 60, 40, 255)
    assert rotational_symmetry(picture) == 1


def test_light_from_one_side_does_not_break_the_symmetry_of_a_block() -> None:
    picture = drawn(polygon(4))
    shade = np.linspace(0.95, 1.05, 200)[None, :, None]
    picture[..., :3] = np.clip(picture[..., :3] * shade, 0, 255)
    assert rotational_symmetry(picture) == 4


@pytest.mark.parametrize("shape", [(0, 0, 4), (10, 10, 4), (10, 10, 3)])
def test_a_picture_without_an_object_has_no_symmetry(shape: tuple[int, ...]) -> None:
    assert rotational_symmetry(np.zeros(shape, np.uint8)) == 1


@given(ANGLES, ANGLES, st.integers(1, 12))
def test_the_smallest_turn_is_symmetric_and_at_most_half_a_period(a: float, b: float, order: int) -> None:
    error = abs(smallest_turn(a - b, order))
    assert 0 <= error <= np.pi / order + 1e-9
    assert error == pytest.approx(abs(smallest_turn(b - a, order)), abs=1e-9)


@given(st.integers(1, 12), st.integers(-5, 5))
def test_whole_periods_are_no_turn(order: int, times: int) -> None:
    assert smallest_turn(times * 2 * np.pi / order, order) == pytest.approx(0, abs=1e-9)


def test_a_round_object_needs_no_turn() -> None:
    assert smallest_turn(1.7, 0) == 0


def test_an_impossible_order_is_refused() -> None:
    with pytest.raises(ValueError, match="order -1"):
        smallest_turn(0, -1)
