from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vcage.base.geometry import boxes_overlap
from vcage.layout.placement.free_region import free_region, nearest_in_rectangles

BOUNDS = np.array([[-0.5, -0.3], [0.5, 0.3]])


def boxes(rng: np.random.Generator, count: int) -> np.ndarray:
    lower = rng.uniform([-0.6, -0.4], [0.45, 0.25], (count, 2))
    return np.stack([lower, lower + rng.uniform(0.02, 0.3, (count, 2))], axis=1)


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(0, 12))
def test_the_region_is_exactly_where_the_footprint_touches_nothing(seed, count):
    rng = np.random.default_rng(seed)
    obstacles, half, gap = boxes(rng, count), rng.uniform(0.01, 0.1, 2), 0.01
    rectangles = free_region(BOUNDS, half, obstacles, gap).rectangles()
    for point in rng.uniform(BOUNDS[0], BOUNDS[1], (60, 2)):
        box = np.stack([point - half, point + half])
        clear = not any(boxes_overlap(box, obstacle, gap) for obstacle in obstacles)
        clear &= bool(np.all(box[0] >= BOUNDS[0]) and np.all(box[1] <= BOUNDS[1]))
        inside = bool(np.any(np.all((rectangles[:, 0] <= point) & (point <= rectangles[:, 1]), axis=1)))
        assert inside == clear


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(0, 12))
def test_samples_nearest_points_and_corners_lie_in_the_region(seed, count):
    rng = np.random.default_rng(seed)
    region = free_region(BOUNDS, rng.uniform(0.01, 0.05, 2), boxes(rng, count), 0.01)
    if region.is_empty:
        return
    for point in [region.sample(rng), region.nearest(rng.uniform(-1, 1, 2)), *region.corners()]:
        assert np.abs(nearest_in_rectangles(point, region.rectangles()) - point).max() < 1e-12


def test_the_area_without_obstacles_is_the_shrunken_workspace():
    assert free_region(BOUNDS, [0.1, 0.05]).area == pytest.approx(0.8 * 0.5)


def test_overlapping_obstacles_are_not_counted_twice():
    twice = [[[0, 0], [0.1, 0.1]]] * 2
    assert free_region(BOUNDS, [0, 0], twice).area == pytest.approx(0.6 - 0.01)


def test_an_exact_fit_leaves_one_point():
    region = free_region(BOUNDS, [0.5, 0.3])
    assert np.abs(region.sample(np.random.default_rng(0))).max() < 1e-8


def test_an_object_larger_than_the_workspace_has_no_region():
    region = free_region(BOUNDS, [0.51, 0.1])
    assert region.is_empty and region.area == 0
    with pytest.raises(ValueError, match="empty"):
        region.sample(np.random.default_rng(0))
    with pytest.raises(ValueError, match="empty"):
        region.nearest([0, 0])


def test_only_allowed_rectangles_are_free():
    region = free_region(BOUNDS, [0.01, 0.01], unions=[[[[0, 0], [0.1, 0.1]], [[0.05, 0], [0.2, 0.1]]]])
    assert region.area == pytest.approx(0.02)


def test_no_allowed_rectangle_leaves_nothing():
    assert free_region(BOUNDS, [0.01, 0.01], unions=[[]]).is_empty


def test_samples_are_spread_by_area():
    allowed = [[[-0.4, -0.2], [-0.1, 0.2]], [[0.2, -0.2], [0.3, 0.2]]]  # 3 : 1
    region = free_region(BOUNDS, [0.01, 0.01], unions=[allowed])
    rng = np.random.default_rng(0)
    left = np.mean([region.sample(rng)[0] < 0 for _ in range(1000)])
    assert 0.70 < left < 0.80


def test_the_centre_lies_in_every_given_union():
    unions = [[[[0, 0], [0.2, 0.2]]], [[[0.1, -1], [1, 1]]], [[[-1, -1], [1, 0.05]]]]
    assert free_region(BOUNDS, [0, 0], unions=unions).area == pytest.approx(0.1 * 0.05)
    assert free_region(BOUNDS, [0, 0], unions=[[[[0, 0], [1, 1]]], []]).is_empty


def test_many_samples_are_like_one_by_one():
    region = free_region(BOUNDS, [0.01, 0.01], boxes(np.random.default_rng(0), 5), 0.01)
    for point in region.samples(np.random.default_rng(1), 50):
        assert np.abs(nearest_in_rectangles(point, region.rectangles()) - point).max() < 1e-12
    assert region.samples(np.random.default_rng(1), 0).shape == (0, 2)
