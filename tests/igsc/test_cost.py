from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import approx_fprime

from vcage.igsc.cost import LayoutProblem, Weights, evaluate, penetrations

BOUNDS = np.array([[-0.5, -0.3], [0.5, 0.3]])


def problem(rng: np.random.Generator, count: int) -> LayoutProblem:
    allowed = [
        None if k % 2 else np.array([[[-0.2, -0.2], [0.0, 0.0]], [[0.1, 0.0], [0.3, 0.2]]]) for k in range(count)
    ]
    target = rng.uniform(BOUNDS[0], BOUNDS[1], (count, 2))
    return LayoutProblem(rng.uniform(0.02, 0.15, (count, 2)), target, BOUNDS, 0.01, tuple(allowed))


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 8))
def test_the_gradient_agrees_with_finite_differences(seed, count):
    rng = np.random.default_rng(seed)
    task, weights = problem(rng, count), Weights(*rng.uniform(0.1, 10, 4))
    centres = rng.uniform(1.3 * BOUNDS[0], 1.3 * BOUNDS[1], (count, 2))
    _, gradient = evaluate(task, weights, centres)
    numeric = approx_fprime(centres.ravel(), lambda flat: evaluate(task, weights, flat.reshape(-1, 2))[0].total, 1e-7)
    assert gradient.ravel() == pytest.approx(numeric, abs=2e-4)


def pair(gap: float) -> tuple[LayoutProblem, np.ndarray]:
    """Two 0.1 squares side by side, ``gap`` apart, margin 0.01."""
    centres = np.array([[0.0, 0.0], [0.1 + gap, 0.0]])
    return LayoutProblem(np.full((2, 2), 0.05), centres, BOUNDS, 0.01, (None, None)), centres


def test_a_layout_at_its_targets_without_overlap_costs_nothing():
    cost, gradient = evaluate(pair(0.02)[0], Weights(), pair(0.02)[1])
    assert cost.total == 0
    assert not gradient.any()


def test_the_margin_is_part_of_the_collision():
    assert evaluate(pair(0.005)[0], Weights(), pair(0.005)[1])[0].collision > 0


def test_a_shallow_collision_costs_about_the_square_of_its_depth():
    task, centres = pair(-0.002)
    assert evaluate(task, Weights(), centres)[0].collision == pytest.approx(0.012**2, rel=0.02)


def test_larger_objects_weigh_more():
    task = LayoutProblem(np.array([[0.1, 0.1], [0.05, 0.05]]), np.zeros((2, 2)), BOUNDS, 0.01, (None, None))
    assert task.weight == pytest.approx([1.6, 0.4])


def test_sticking_out_of_the_workspace_costs_its_square():
    task = LayoutProblem(np.array([[0.1, 0.1]]), np.array([[0.43, 0.0]]), BOUNDS, 0.01, (None,))
    assert evaluate(task, Weights(), task.target)[0].boundary == pytest.approx(0.03**2)


def test_penetrations_are_negative_for_what_is_apart():
    _, _, depth = penetrations(*pair(0.02))
    assert depth[0, 0] == pytest.approx(-0.01)
