from __future__ import annotations

import numpy as np
import pytest

from vcage.errors import InfeasibleScene
from vcage.igsc.cost import LayoutProblem, Weights
from vcage.igsc.solver import is_feasible, repair, solve

BOUNDS = np.array([[-0.5, -0.3], [0.5, 0.3]])


def squares(targets: list[tuple[float, float]], half: float = 0.05, allowed=None) -> LayoutProblem:
    n = len(targets)
    return LayoutProblem(np.full((n, 2), half), np.array(targets, dtype=float), BOUNDS, 0.01, allowed or (None,) * n)


def test_a_feasible_target_is_left_alone():
    task = squares([(0, 0), (0.2, 0)])
    solution = solve(task, ["a", "b"], Weights(), np.random.default_rng(0), 4)
    assert solution.starts == 0
    assert (solution.centres == task.target).all()


def test_two_overlapping_squares_move_apart_by_just_what_is_needed():
    task = squares([(-0.03, 0.0), (0.03, 0.0)])
    centres = solve(task, ["a", "b"], Weights(), np.random.default_rng(0), 4).centres
    assert abs(centres[1, 0] - centres[0, 0]) == pytest.approx(0.11, abs=0.002)
    assert np.abs(centres[:, 1]).max() < 0.002
    assert np.hypot(*(centres - task.target).T) == pytest.approx([0.025, 0.025], abs=0.002)


def test_objects_with_the_same_target_come_apart():
    task = squares([(0.1, 0.1)] * 4)
    assert is_feasible(task, solve(task, list("abcd"), Weights(), np.random.default_rng(0), 4).centres)


def test_repair_moves_the_smaller_one_to_the_nearest_free_point():
    task = LayoutProblem(
        np.array([[0.02, 0.02], [0.1, 0.1]]), np.array([[0.1, 0.0], [0.0, 0.0]]), BOUNDS, 0.01, (None, None)
    )
    fixed, moved = repair(task, task.target)
    assert moved == (0,)
    assert fixed == pytest.approx(np.array([[0.13, 0.0], [0.0, 0.0]]), abs=1e-6)


def test_repair_gives_up_where_nothing_is_free():
    assert repair(squares([(0, 0), (0, 0)], half=0.29), np.zeros((2, 2))) is None


def test_centres_end_where_they_are_allowed():
    allowed = np.array([[[0.2, 0.0], [0.4, 0.2]]])
    task = squares([(-0.2, 0), (0, 0)], allowed=(allowed, None))
    centres = solve(task, ["a", "b"], Weights(), np.random.default_rng(0), 4).centres
    assert centres[0] == pytest.approx([0.2, 0.0], abs=0.002)
    assert is_feasible(task, centres)


def test_a_tight_layout_is_found_by_packing():
    targets = [(0.0, 0.0)] * 6
    task = LayoutProblem(np.tile([0.15, 0.14], (6, 1)), np.array(targets), BOUNDS, 0.01, (None,) * 6)
    assert is_feasible(task, solve(task, list("abcdef"), Weights(), np.random.default_rng(0), 1).centres)


def test_what_cannot_be_solved_is_infeasible_with_names():
    with pytest.raises(InfeasibleScene, match="c"):
        solve(squares([(0, 0)] * 3, half=0.17), ["a", "b", "c"], Weights(), np.random.default_rng(0), 2)
