"""Free rectangles and grasp widths on shapes whose answers are known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vcage.base.geometry import box_corners
from vcage.objects.convex import Convex
from vcage.objects.modelling import pieces
from vcage.objects.openings import (
    closed_width,
    grasped_width,
    largest_rectangle,
    room_inside,
    room_under_roof,
    surface_on_top,
)


def _convex(solids) -> list[Convex]:
    return [Convex.of(solid.vertices) for solid in solids]


def _box(lower, upper) -> Convex:
    return Convex.of(box_corners(lower, upper))


def test_the_inside_of_an_open_box_is_its_inner_size() -> None:
    opening = room_inside(_convex(pieces.tray((0.2, 0.1), 0.01, 0.005, 0.05)), (0, 0, 0.005))
    np.testing.assert_allclose(opening.size, (0.2, 0.1), atol=0.001)
    np.testing.assert_allclose((opening.floor, opening.rim, opening.depth), (0.005, 0.05, 0.045), atol=1e-9)


def test_the_inside_of_a_round_wall_is_the_inscribed_square() -> None:
    floor = pieces.stack([(0.05, 0), (0.05, 0.005)])
    wall = pieces.ring([(0.045, 0.005), (0.05, 0.005), (0.05, 0.05), (0.045, 0.05)])
    opening = room_inside(_convex([floor, *wall]), (0, 0, 0.005))
    assert np.prod(opening.size) == pytest.approx(2 * 0.045**2, rel=0.06)


def test_a_bare_top_is_free_to_its_edges() -> None:
    opening = surface_on_top([_box((-0.02, -0.03, 0), (0.02, 0.03, 0.04))], (0, 0, 0.04))
    np.testing.assert_allclose(opening.size, (0.04, 0.06), atol=0.001)
    assert opening.rim == opening.floor


def test_objects_on_a_surface_limit_it() -> None:
    slab, post = _box((-0.1, -0.1, 0), (0.1, 0.1, 0.01)), _box((0.05, -0.1, 0.01), (0.06, 0.1, 0.05))
    opening = surface_on_top([slab, post], (0, 0, 0.01))
    np.testing.assert_allclose(opening.size, (0.15, 0.2), atol=0.001)
    assert opening.rim == pytest.approx(0.05)


def test_a_point_over_nothing_is_an_error() -> None:
    with pytest.raises(ValueError, match="no surface"):
        room_inside([_box((0, 0, 0), (1, 1, 0.01))], (0.5, 0.5, 0.2))


def test_the_width_in_a_wall_is_the_walls_thickness() -> None:
    walls = [_box((-0.1, y, 0), (0.1, y + 0.004, 0.05)) for y in (-0.03, 0.03)]
    assert grasped_width(walls, (0, 0.032, 0.04), (0, 1, 0)) == pytest.approx(0.004)


def test_the_width_in_a_hollow_is_from_outside_to_outside() -> None:
    walls = [_box((-0.1, y, 0), (0.1, y + 0.004, 0.05)) for y in (-0.03, 0.03)]
    assert grasped_width(walls, (0, 0, 0.04), (0, 1, 0)) == pytest.approx(0.064)


def test_the_width_beside_an_object_is_zero() -> None:
    assert grasped_width([_box((0, 0, 0), (1, 1, 1))], (0.5, -0.1, 0.5), (0, 1, 0)) == 0
    assert grasped_width([_box((0, 0, 0), (1, 1, 1))], (0.5, 0.5, 2), (0, 1, 0)) == 0


def test_touching_pieces_count_as_one() -> None:
    halves = [_box((0, 0, 0), (0.02, 1, 1)), _box((0.02, 0, 0), (0.03, 1, 1))]
    assert grasped_width(halves, (0.01, 0.5, 0.5), (1, 0, 0)) == pytest.approx(0.03)


def test_fingers_stop_at_the_widest_part_between_them() -> None:
    wide_and_narrow = [_box((0.0, -0.03, 0), (0.01, 0.03, 1)), _box((0.01, -0.02, 0), (0.05, 0.02, 1))]
    along = [(x, 0, 0.5) for x in (0.005, 0.02, 0.04)]
    assert closed_width(wide_and_narrow, along, (0, 1, 0), 0.1) == pytest.approx(0.06)
    assert closed_width(wide_and_narrow, along[1:], (0, 1, 0), 0.1) == pytest.approx(0.04)


def test_fingers_that_begin_inside_a_part_are_stopped_where_they_begin() -> None:
    assert closed_width([_box((0, -0.05, 0), (1, 0.05, 1))], [(0.5, 0, 0.5)], (0, 1, 0), 0.08) == pytest.approx(0.08)


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 7), st.integers(1, 7), st.integers(0, 2**32 - 1))
def test_the_rectangle_is_free_holds_the_cell_and_is_the_largest(rows: int, columns: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    free = rng.random((rows, columns)) < 0.75
    row, column = int(rng.integers(rows)), int(rng.integers(columns))
    found = largest_rectangle(free, row, column)
    best = 0
    for r0 in range(row + 1):
        for r1 in range(row + 1, rows + 1):
            for c0 in range(column + 1):
                for c1 in range(column + 1, columns + 1):
                    if free[r0:r1, c0:c1].all():
                        best = max(best, (r1 - r0) * (c1 - c0))
    if found is None:
        assert best == 0
    else:
        r0, r1, c0, c1 = found
        assert r0 <= row < r1 and c0 <= column < c1 and free[r0:r1, c0:c1].all()
        assert (r1 - r0) * (c1 - c0) == best


OVEN = [
    [(-0.1, -0.1, 0.0), (0.1, 0.1, 0.02)],
    [(-0.1, -0.1, 0.12), (0.1, 0.1, 0.14)],
    [(-0.1, -0.1, 0.02), (-0.08, 0.1, 0.12)],
    [(0.08, -0.1, 0.02), (0.1, 0.1, 0.12)],
    [(-0.08, 0.08, 0.02), (0.08, 0.1, 0.12)],
]
"""Bounds of floor, roof, two sides and a back; open at the front."""


def _oven() -> list[Convex]:
    return [_box(lower, upper) for lower, upper in OVEN]


def test_the_room_under_a_roof_is_its_floor_between_the_walls() -> None:
    room = room_under_roof(_oven(), (0, 0, 0.02))
    assert room.size == pytest.approx((0.16, 0.18), abs=0.003)
    assert (room.floor, room.rim) == pytest.approx((0.02, 0.12))


def test_there_is_no_room_inside_from_above_under_a_roof() -> None:
    with pytest.raises(ValueError, match="no free room"):
        room_inside(_oven(), (0, 0, 0.02))


def test_without_a_roof_there_is_no_room_under_it() -> None:
    with pytest.raises(ValueError, match="nothing is over"):
        room_under_roof(_oven()[:1], (0, 0, 0.02))


def test_a_handle_over_a_tray_does_not_lower_its_walls_for_contents() -> None:
    tray = pieces.tray((0.2, 0.1), 0.01, 0.005, 0.04)
    handle = _box((-0.11, -0.005, 0.09), (0.11, 0.005, 0.1))
    opening = room_inside([*_convex(tray), handle], (0, 0.02, 0.005), standing=True)
    assert opening.size[0] == pytest.approx(0.2, abs=0.002)
    assert opening.rim == pytest.approx(0.1)


def test_contents_between_sloping_walls_have_less_room_than_dropped_objects() -> None:
    floor = pieces.stack([(0.05, 0), (0.05, 0.005)])
    wall = pieces.ring([(0.02, 0.005), (0.05, 0.005), (0.05, 0.05), (0.045, 0.05)])
    bowl = _convex([floor, *wall])
    standing, dropped = (room_inside(bowl, (0, 0, 0.005), standing=flag) for flag in (True, False))
    assert standing.size[0] < dropped.size[0] - 0.01
    assert (standing.floor, standing.rim) == (dropped.floor, dropped.rim)
