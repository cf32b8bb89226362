"""How the use of the table is measured."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.layouts import fill

REGION = np.array([[[-0.4, -0.2], [0.0, 0.2]], [[-0.1, -0.2], [0.4, 0.0]]])
"""An L of two rectangles that overlap."""


@given(st.integers(0, 1000))
def test_uniform_positions_fill_their_region(seed: int):
    rng = np.random.default_rng(seed)
    points = rng.uniform(-0.4, 0.4, (2000, 2))
    inside = np.any([np.all((low <= points) & (points <= high), axis=1) for low, high in REGION], axis=0)
    assert fill(points[inside][:100], REGION) == pytest.approx(1.0, abs=0.2)


def test_one_fixed_position_fills_almost_nothing():
    assert fill(np.zeros((100, 2)), REGION) < 0.02


def test_positions_in_one_half_fill_about_half():
    points = np.random.default_rng(0).uniform([0.0, -0.2], [0.4, 0.0], (500, 2))
    assert fill(points, np.array([[[-0.4, -0.2], [0.4, 0.0]]])) == pytest.approx(0.5, abs=0.1)
