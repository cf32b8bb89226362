"""Heaps: balls that lie loose in a vessel."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from tests.example_scenes import thing
from vcage.objects.heaps import heap
from vcage.tasks.stowing import open_point

RADIUS = 0.01


def balls_in(name: str, count: int) -> tuple[list[np.ndarray] | None, float, float]:
    """Middles of balls in a vessel, and the heights of its floor and rim."""
    asset = thing(name).asset
    point = open_point(asset)
    assert point is not None
    opening = asset.opening(point)
    return heap(asset.pieces, opening, [RADIUS] * count, np.random.default_rng(0)), opening.floor, opening.rim


@pytest.mark.parametrize(
    ("name", "count"), [("cup", 5), ("mug", 5), ("small_bin", 5), ("small_bowl", 8), ("dustbin", 20)]
)
def test_balls_lie_beside_and_on_each_other_below_the_rim(name: str, count: int) -> None:
    middles, floor, rim = balls_in(name, count)
    assert middles is not None and len(middles) == count
    assert min(np.linalg.norm(a - b) for a, b in itertools.combinations(middles, 2)) >= 2 * RADIUS
    assert all(floor + RADIUS <= middle[2] <= rim - RADIUS for middle in middles)


def test_balls_touch_no_wall() -> None:
    middles, *_ = balls_in("cup", 5)
    assert min(piece.outside(np.array(middles)).min() for piece in thing("cup").asset.pieces) >= RADIUS


def test_more_balls_than_a_vessel_holds_are_no_heap() -> None:
    assert balls_in("cup", 30)[0] is None
