from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vcage.base.geometry import boxes_overlap
from vcage.layout.cost import LayoutProblem
from vcage.layout.repair import is_feasible, repair

BOUNDS = np.array([[-0.5, -0.3], [0.5, 0.3]])


def squares(targets: list[tuple[float, float]], half: float = 0.05, allowed=None) -> LayoutProblem:
    n = len(targets)
    return LayoutProblem(np.full((n, 2), half), np.array(targets, dtype=float), BOUNDS, 0.01, allowed or (None,) * n)


def test_repair_moves_the_smaller_one_to_the_nearest_free_point():
    task = LayoutProblem(
        np.array([[0.02, 0.02], [0.1, 0.1]]), np.array([[0.1, 0.0], [0.0, 0.0]]), BOUNDS, 0.01, (None, None)
    )
    fixed, moved = repair(task, task.target)
    assert moved == (0,)
    assert fixed == pytest.approx(np.array([[0.13, 0.0], [0.0, 0.0]]), abs=1e-6)


def test_repair_leaves_an_exact_layout_unchanged():
    task = squares([(0, 0), (0.11, 0)])
    fixed, moved = repair(task, task.target)
    assert moved == ()
    assert (fixed == task.target).all()


def test_repair_gives_up_where_nothing_is_free():
    assert repair(squares([(0, 0), (0, 0)], half=0.29), np.zeros((2, 2)), tries=10) is None


def test_hard_objects_are_placed_first_at_the_next_try():
    # The larger one stands in the only spot that the smaller one reaches.
    allowed = np.array([[[-0.05, -0.05], [0.05, 0.05]]])
    task = LayoutProblem(np.array([[0.18, 0.2], [0.1, 0.1]]), np.zeros((2, 2)), BOUNDS, 0.01, (None, allowed))
    assert repair(task, task.target) is None
    fixed, moved = repair(task, task.target, tries=2)
    assert moved == (0,)
    assert is_feasible(task, fixed)


@pytest.mark.parametrize(
    "centres",
    [[(0.46, 0), (0, 0)], [(0, 0), (0.1, 0.1)], [(0.3, 0.1), (0, 0)]],
    ids=["out", "touch", "unreached"],
)
def test_the_exact_check_finds(centres):
    task = squares(centres, allowed=(np.array([[[-0.1, -0.1], [0.2, 0.2]], [[0.4, 0], [0.5, 0.1]]]), None))
    assert not is_feasible(task, task.target)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 12))
def test_repair_returns_exact_layouts(seed, count):
    rng = np.random.default_rng(seed)
    half = rng.uniform(0.02, 0.1, (count, 2))
    task = LayoutProblem(half, rng.uniform(*BOUNDS, (count, 2)), BOUNDS, 0.01, (None,) * count)
    repaired = repair(task, task.target, tries=5)
    if repaired is None:
        return
    boxes = np.stack([repaired[0] - half, repaired[0] + half], axis=1)
    assert np.all(boxes[:, 0] >= BOUNDS[0] - 1e-7) and np.all(boxes[:, 1] <= BOUNDS[1] + 1e-7)
    assert not any(boxes_overlap(a, b, 0.01 - 1e-7) for a, b in combinations(boxes, 2))
    assert set(np.flatnonzero(np.any(repaired[0] != task.target, axis=1))) == set(repaired[1])


def test_repair_finds_places_for_a_few_on_an_empty_table():
    assert repair(squares([(0, 0)] * 8), np.zeros((8, 2))) is not None
