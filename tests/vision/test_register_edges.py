from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vcage.vision.register_edges import SETTINGS, Axis, Profile, agrees, laid, table_edges


def lab(back: float, front: float, height: int = 240, width: int = 320) -> np.ndarray:
    """An even table on even ground as CIELAB, its edges to a part of a pixel."""
    rows = np.arange(height)
    share = np.clip(rows + 0.5 - back, 0, 1) * np.clip(front - rows - 0.5 + 1, 0, 1)
    colours = np.array([140, 138, 134]) + share[:, None] * np.array([80, 60, 30])
    picture = np.repeat(np.round(colours).astype(np.uint8)[:, None], width, axis=1)
    return cv2.cvtColor(np.ascontiguousarray(picture), cv2.COLOR_RGB2LAB)


@settings(max_examples=30, deadline=None)
@given(back=st.floats(20, 60), front=st.floats(170, 215))
def test_edges_are_found_to_a_part_of_a_pixel(back, front) -> None:
    near, far = table_edges(Profile.of(lab(back, front), 0))
    assert far.at - near.at == pytest.approx(front - back + 0.5, abs=0.8)


@settings(max_examples=30, deadline=None)
@given(scale=st.floats(0.8, 1.2), middle=st.floats(-8, 8))
def test_the_fitted_scale_lays_the_lines_over_the_moved_edges(scale, middle) -> None:
    empty = Profile.of(lab(45, 195), 0)
    seen = Profile.of(lab(120 + middle - 75 * scale, 120 + middle + 75 * scale), 0)
    (axis,) = laid(empty, table_edges(empty), seen)
    assert axis.scale == pytest.approx(1 / scale, abs=0.01)


def test_upright_edges_match_those_of_the_rotated_picture() -> None:
    picture = lab(40, 200)
    lying = np.ascontiguousarray(picture.transpose(1, 0, 2))
    level, upright = table_edges(Profile.of(picture, 0)), table_edges(Profile.of(lying, 1))
    assert [line.at for line in level] == pytest.approx([line.at for line in upright], abs=0.1)


def test_edges_agree_within_the_pixels_allowed_only() -> None:
    edges = table_edges(Profile.of(lab(40, 200), 0))
    moved = Profile.of(lab(42, 202), 0)
    assert agrees(edges, moved, 2.5) and not agrees(edges, moved, 1.5)


@pytest.mark.parametrize("shape", [(480, 640), (2, 2), (1, 900), (900, 1)])
def test_an_even_picture_has_no_lines(shape) -> None:
    empty = Profile.of(np.full((*shape, 3), 128, np.uint8), 0)
    assert empty.lines(SETTINGS.share) == [] and table_edges(empty) is None


@given(scale=st.floats(0.5, 2), shift=st.floats(-50, 50), at=st.floats(0, 500))
def test_axes_follow_each_other(scale, shift, at) -> None:
    first, then = Axis(scale, shift), Axis(1.25, -3)
    assert then.after(first)(at) == pytest.approx(then(first(at)))


def test_an_axis_between_two_ranges_keeps_the_borders_of_pixels() -> None:
    axis = Axis.between((10, 30), (0, 640))
    assert axis(9.5) == pytest.approx(-0.5) and axis(29.5) == pytest.approx(639.5)
