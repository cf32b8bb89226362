"""The exact test of the benchmarks: how deep convex solids enter each other."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks._shapes import TOUCHING, box_around, box_depths, penetration, pieces_collide
from vcage.base.geometry import Pose, box_corners

BOX = box_corners([0, 0, 0], [0.1, 0.1, 0.1])


@settings(deadline=None, max_examples=30)
@given(st.tuples(*[st.floats(-0.15, 0.15)] * 3))
def test_penetration_of_two_equal_boxes_is_their_least_overlap(shift: tuple[float, float, float]) -> None:
    expected = max(0.0, 0.1 - max(abs(x) for x in shift))
    assert penetration(BOX, BOX + shift) == pytest.approx(expected, abs=1e-9)


@settings(deadline=None, max_examples=30)
@given(
    st.tuples(*[st.floats(-0.15, 0.15)] * 3),
    st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1),
)
def test_penetration_is_the_same_from_either_side_and_no_deeper_than_the_boxes(p, q) -> None:
    other = Pose(p, q).apply(BOX)
    depth = penetration(BOX, other)
    assert depth == pytest.approx(penetration(other, BOX), abs=1e-9)
    assert depth <= max(0.0, box_depths(box_around(BOX)[None], box_around(other)[None]).item()) + 1e-9


def test_two_edges_that_cross_are_parted_across_both() -> None:
    """Two bars with their edges up and down, one above the other at a right angle: no face normal parts them best."""
    bar = Pose(q=[np.cos(np.pi / 8), np.sin(np.pi / 8), 0, 0]).apply(
        box_corners([-0.2, -0.01, -0.01], [0.2, 0.01, 0.01])
    )
    height = 2 * np.sqrt(2) * 0.01
    across = Pose.from_yaw([0, 0, height - 0.003], np.pi / 2).apply(bar)
    assert penetration(bar, across) == pytest.approx(0.003, abs=1e-9)


@pytest.mark.parametrize(("depth", "collides"), [(TOUCHING - 1e-4, False), (TOUCHING + 1e-4, True), (-0.01, False)])
def test_one_pair_of_pieces_too_deep_is_enough(depth: float, collides: bool) -> None:
    far = BOX + 5.0
    assert pieces_collide([far, BOX], [BOX + [0.1 - depth, 0, 0]]) is collides


def test_a_thin_plate_through_a_block_collides() -> None:
    """It overlaps the block by its own 2 mm only, but no shift of 5 mm parts them."""
    plate = box_corners([-0.1, -0.1, 0.05], [0.2, 0.2, 0.052])
    assert pieces_collide([plate], [BOX]) is True


def test_an_object_without_pieces_meets_nothing() -> None:
    assert pieces_collide([], [BOX]) is False
