"""Where a camera sees a box whole: no rectangle shows too much, and straight from above none shows too little."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.layout.items import unplaced
from vcage.base.errors import UsageError
from vcage.base.geometry import Camera, box_corners, footprint_half_size, look_at
from vcage.layout.items import Placement, TableItem
from vcage.layout.placement.place import place
from vcage.layout.placement.view import view_rectangles

TABLE = 0.74
BOUNDS = np.array([[-0.6, -0.35], [0.6, 0.35]])
ABOVE = Camera(640, 480, 0.51, look_at((0, 0, 2.34), (0, 0, TABLE), up=(0, 1, 0)))


def margin(camera: Camera, rectangle: np.ndarray, height: float) -> float:
    """Pixels between a box on the table and the nearest edge of the picture; negative where it is cut off."""
    corners = box_corners([*rectangle[0], TABLE], [*rectangle[1], TABLE + height])
    pixels = camera.project(corners)
    if np.isnan(pixels).any():
        return -np.inf
    return float(np.min([pixels, (camera.width, camera.height) - pixels]))


@settings(max_examples=40, deadline=None)
@given(
    x=st.floats(-1, 1),
    y=st.floats(-1.2, 1.2),
    z=st.floats(0.9, 2.5),
    fovy=st.floats(0.3, 1.4),
    height=st.floats(0, 0.5),
)
def test_a_box_over_any_of_the_rectangles_is_seen_whole_by_any_camera(x, y, z, fovy, height):
    camera = Camera(320, 240, fovy, look_at((x, y, z), (0.1, 0.05, TABLE), up=(0, 1, 0.1)))
    for rectangle in view_rectangles(camera, TABLE, height, BOUNDS):
        assert margin(camera, rectangle, height) >= -1e-5
        assert np.all(rectangle[0] >= BOUNDS[0]) and np.all(rectangle[1] <= BOUNDS[1])


@pytest.mark.parametrize("height", [0.0, 0.1, 0.4])
def test_straight_from_above_there_is_one_rectangle_and_it_ends_at_the_pictures_edge(height: float):
    (rectangle,) = view_rectangles(ABOVE, TABLE, height, BOUNDS * 10)
    assert margin(ABOVE, rectangle, height) == pytest.approx(0, abs=1e-6)
    assert margin(ABOVE, rectangle + [[-0.002, 0], [0, 0]], height) < 0
    assert margin(ABOVE, rectangle + [[0, 0], [0, 0.002]], height) < 0


def test_a_border_keeps_pixels_free():
    (rectangle,) = view_rectangles(ABOVE, TABLE, 0.2, BOUNDS * 10, border=8)
    assert margin(ABOVE, rectangle, 0.2) == pytest.approx(8, abs=1e-6)


def test_the_view_of_a_tilted_camera_is_filled_up_to_a_strip():
    camera = Camera(640, 480, 0.6, look_at((0, -0.9, 1.6), (0, 0, TABLE)))
    rectangles = view_rectangles(camera, TABLE, 0.1, BOUNDS)
    points = np.random.default_rng(0).uniform(*BOUNDS, (2000, 2))
    seen = np.array([margin(camera, np.stack([p, p]), 0.1) >= 0 for p in points])
    covered = np.any(np.all((rectangles[:, 0] <= points[:, None]) & (points[:, None] <= rectangles[:, 1]), 2), axis=1)
    assert not np.any(covered & ~seen)
    assert np.mean(seen & ~covered) < 0.02 < np.mean(seen)


def footprint(item: TableItem, at: Placement) -> np.ndarray:
    """(2, 2) the axis-aligned rectangle that a placed item covers."""
    half = footprint_half_size(item.size[:2], at.yaw)
    return np.array([at.x, at.y]) + np.array([-half, half])


def test_an_object_as_high_as_the_camera_is_seen_nowhere():
    assert view_rectangles(ABOVE, TABLE, 1.6, BOUNDS).shape == (0, 2, 2)


def test_a_tall_object_is_placed_where_all_of_it_is_seen():
    workspace, height = BOUNDS, 0.4
    within = view_rectangles(ABOVE, TABLE, height, workspace)
    item = unplaced("bottle", (0.3, 0.1), (0.0, 0.6, 1.2), within=within)
    cut_off = replace(item, within=None)
    rng = np.random.default_rng(0)
    seen, free = (
        [margin(ABOVE, footprint(i, place([i], workspace, rng)["bottle"]), height) for _ in range(40)]
        for i in (item, cut_off)
    )
    assert min(seen) >= -1e-5 and min(free) < 0


@pytest.mark.parametrize(
    ("height", "border", "bounds"),
    [(-0.1, 0, BOUNDS), (np.nan, 0, BOUNDS), (0.1, -1, BOUNDS), (0.1, 0, BOUNDS[::-1])],
    ids=["negative height", "nan", "negative border", "inverted bounds"],
)
def test_a_view_that_makes_no_sense_is_refused(height, border, bounds):
    with pytest.raises(UsageError):
        view_rectangles(ABOVE, TABLE, height, bounds, border)
