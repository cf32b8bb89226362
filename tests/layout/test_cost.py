from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import approx_fprime

from vcage.base.errors import UsageError
from vcage.layout.cost import CostWeights, LayoutProblem, evaluate, penetrations

BOUNDS = np.array([[-0.5, -0.3], [0.5, 0.3]])
NOTHING = CostWeights(collision=0, displacement=0, boundary=0, reach=0, relation=0)


def problem(rng: np.random.Generator, count: int) -> LayoutProblem:
    rectangles = np.array([[[-0.2, -0.2], [0.0, 0.0]], [[0.1, 0.0], [0.3, 0.2]], [[-0.1, 0.1], [0.0, 0.2]]])
    allowed = [None if k % 2 else rectangles[: 1 + k % 3] for k in range(count)]
    target = rng.uniform(BOUNDS[0], BOUNDS[1], (count, 2))
    extra = rng.uniform(0, 0.05, (count, count))
    return LayoutProblem(rng.uniform(0.02, 0.15, (count, 2)), target, BOUNDS, 0.01, tuple(allowed), extra + extra.T)


@pytest.mark.parametrize("term", ["collision", "displacement", "boundary", "reach"])
@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 8))
def test_the_gradient_of_each_term_agrees_with_finite_differences(term, seed, count):
    rng = np.random.default_rng(seed)
    task, weights = problem(rng, count), replace(NOTHING, **{term: 3.0})
    centres = rng.uniform(1.3 * BOUNDS[0], 1.3 * BOUNDS[1], (count, 2))
    _, gradient = evaluate(task, weights, centres)
    numeric = approx_fprime(centres.ravel(), lambda flat: evaluate(task, weights, flat.reshape(-1, 2))[0].total, 1e-7)
    assert np.ravel(gradient + np.zeros_like(centres)) == pytest.approx(numeric, abs=5e-5)


def test_the_total_is_the_weighted_sum_of_the_terms():
    rng = np.random.default_rng(0)
    task, weights = problem(rng, 6), CostWeights(2, 3, 5, 7, 11)
    cost, _ = evaluate(task, weights, rng.uniform(1.3 * BOUNDS[0], 1.3 * BOUNDS[1], (6, 2)))
    parts = 2 * cost.collision + 3 * cost.displacement + 5 * cost.boundary + 7 * cost.reach + 11 * cost.relation
    assert cost.total == pytest.approx(parts)
    assert min(cost.collision, cost.displacement, cost.boundary, cost.reach) > 0


@pytest.mark.parametrize("value", [np.nan, np.inf, -1.0])
@pytest.mark.parametrize("term", ["collision", "displacement", "boundary", "reach", "relation"])
def test_a_weight_that_makes_no_sense_is_refused(term, value):
    with pytest.raises(UsageError, match=term):
        CostWeights(**{term: value})


def pair(gap: float) -> tuple[LayoutProblem, np.ndarray]:
    """Two 0.1 squares side by side, ``gap`` apart, margin 0.01."""
    centres = np.array([[0.0, 0.0], [0.1 + gap, 0.0]])
    return LayoutProblem(np.full((2, 2), 0.05), centres, BOUNDS, 0.01, (None, None)), centres


def test_a_layout_at_its_targets_without_overlap_costs_nothing():
    cost, gradient = evaluate(pair(0.02)[0], CostWeights(), pair(0.02)[1])
    assert cost.total == 0
    assert not gradient.any()


def test_the_margin_is_part_of_the_collision():
    assert evaluate(pair(0.005)[0], CostWeights(), pair(0.005)[1])[0].collision > 0


def test_the_extra_gap_of_a_pair_is_part_of_the_collision():
    task, centres = pair(0.02)
    wider = replace(task, extra=np.full((2, 2), 0.03))
    assert evaluate(wider, CostWeights(), centres)[0].collision > 0


def test_a_shallow_collision_costs_about_the_square_of_its_depth():
    task, centres = pair(-0.002)
    assert evaluate(task, CostWeights(), centres)[0].collision == pytest.approx(0.012**2, rel=0.02)


def test_larger_objects_weigh_more():
    task = LayoutProblem(np.array([[0.1, 0.1], [0.05, 0.05]]), np.zeros((2, 2)), BOUNDS, 0.01, (None, None))
    assert task.weight == pytest.approx([1.6, 0.4])


def test_sticking_out_of_the_workspace_costs_its_square():
    task = LayoutProblem(np.array([[0.1, 0.1]]), np.array([[0.43, 0.0]]), BOUNDS, 0.01, (None,))
    assert evaluate(task, CostWeights(), task.target)[0].boundary == pytest.approx(0.03**2)


def test_an_object_out_of_reach_costs_its_squared_distance_to_the_nearest_rectangle():
    allowed = np.array([[[0.2, 0.0], [0.3, 0.1]], [[-0.3, 0.0], [-0.1, 0.1]]])
    task = LayoutProblem(np.array([[0.02, 0.02]]), np.zeros((1, 2)), BOUNDS, 0.01, (allowed,))
    assert evaluate(task, CostWeights(), task.target)[0].reach == pytest.approx(0.1**2)
    assert evaluate(task, CostWeights(), np.array([[0.25, 0.05]]))[0].reach == 0


def test_penetrations_are_negative_for_separate_shapes():
    assert penetrations(*pair(0.02))[0, 1] == pytest.approx(-0.01)
