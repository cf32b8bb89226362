from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vcage.base.errors import InfeasibleScene
from vcage.layout.cost import CostWeights, LayoutProblem
from vcage.layout.relation_cost import RelatedBox, relation_terms
from vcage.layout.repair import is_feasible
from vcage.layout.solver import solve
from vcage.schema.plan import Relation

BOUNDS = np.array([[-0.5, -0.3], [0.5, 0.3]])


def squares(targets: list[tuple[float, float]], half: float = 0.05, allowed=None) -> LayoutProblem:
    n = len(targets)
    return LayoutProblem(np.full((n, 2), half), np.array(targets, dtype=float), BOUNDS, 0.01, allowed or (None,) * n)


def test_a_feasible_target_is_left_alone():
    task = squares([(0, 0), (0.2, 0)])
    solution = solve(task, ["a", "b"], CostWeights(), np.random.default_rng(0), 4)
    assert solution.starts == 0
    assert (solution.centres == task.target).all()


def test_two_overlapping_squares_move_apart_by_the_needed_distance():
    task = squares([(-0.03, 0.0), (0.03, 0.0)])
    centres = solve(task, ["a", "b"], CostWeights(), np.random.default_rng(0), 4).centres
    assert abs(centres[1, 0] - centres[0, 0]) == pytest.approx(0.11, abs=0.002)
    assert np.abs(centres[:, 1]).max() < 0.002
    assert np.hypot(*(centres - task.target).T) == pytest.approx([0.025, 0.025], abs=0.002)


def test_objects_with_the_same_target_come_apart():
    task = squares([(0.1, 0.1)] * 4)
    assert is_feasible(task, solve(task, list("abcd"), CostWeights(), np.random.default_rng(0), 4).centres)


def test_centres_end_where_they_are_allowed():
    allowed = np.array([[[0.2, 0.0], [0.4, 0.2]]])
    task = squares([(-0.2, 0), (0, 0)], allowed=(allowed, None))
    centres = solve(task, ["a", "b"], CostWeights(), np.random.default_rng(0), 4).centres
    assert centres[0] == pytest.approx([0.2, 0.0], abs=0.004)
    assert is_feasible(task, centres)


def test_a_tight_layout_is_found_by_packing():
    targets = [(0.0, 0.0)] * 6
    task = LayoutProblem(np.tile([0.15, 0.14], (6, 1)), np.array(targets), BOUNDS, 0.01, (None,) * 6)
    assert is_feasible(task, solve(task, list("abcdef"), CostWeights(), np.random.default_rng(0), 1).centres)


def test_an_unsolvable_layout_is_infeasible_with_names():
    names = ["pan", "pot", "lid"]
    with pytest.raises(InfeasibleScene) as caught:
        solve(squares([(0, 0)] * 3, half=0.17), names, CostWeights(), np.random.default_rng(0), 2)
    (left,) = caught.value.details["objects"]  # two of them fit
    assert left in names and left in caught.value.message


def related(task: LayoutProblem, *plan: tuple[int, str, int]) -> LayoutProblem:
    """The task with a plan among its footprints."""
    spots = {f"o{k}": RelatedBox(k, np.zeros(2), half) for k, half in enumerate(task.half)}
    relations = [Relation(subject=f"o{i}", relation=word, reference=f"o{j}") for i, word, j in plan]
    return replace(task, relations=relation_terms(relations, spots, len(task.half)))


def test_a_relation_that_noise_broke_is_restored():
    task = related(squares([(0.02, 0.0), (0.0, 0.0)]), (0, "left_of", 1))
    solution = solve(task, ["a", "b"], CostWeights(), np.random.default_rng(0), 4)
    assert task.relations.broken(solution.centres) == 0
    assert solution.centres[0, 0] < solution.centres[1, 0]


def test_a_layout_that_keeps_the_plan_already_is_left_alone():
    task = related(squares([(-0.2, 0), (0.2, 0)]), (0, "left_of", 1))
    assert solve(task, ["a", "b"], CostWeights(), np.random.default_rng(0), 4).starts == 0


def test_circular_relations_cost_one_of_them_and_no_collision():
    task = related(squares([(0, 0.1), (0.1, 0), (-0.1, 0)]), (0, "left_of", 1), (1, "left_of", 2), (2, "left_of", 0))
    centres = solve(task, list("abc"), CostWeights(), np.random.default_rng(0), 4).centres
    assert is_feasible(task, centres)
    assert task.relations.broken(centres) == 1


def test_a_relation_that_cannot_be_kept_does_not_prevent_a_layout():
    task = related(squares([(0, 0), (0.1, 0)], half=0.2), (0, "behind", 1), (0, "left_of", 1))
    assert is_feasible(task, solve(task, ["a", "b"], CostWeights(), np.random.default_rng(0), 2).centres)


def test_without_weight_the_plan_is_left_out():
    task = related(squares([(0.2, 0.0), (0.0, 0.0)]), (0, "left_of", 1))
    assert solve(task, ["a", "b"], CostWeights(relation=0), np.random.default_rng(0), 4).starts == 0


def test_wider_gaps_are_given_up_before_the_layout_is():
    task = replace(squares([(0, 0)] * 4, half=0.12), extra=np.full((4, 4), 0.2))
    solution = solve(task, list("abcd"), CostWeights(), np.random.default_rng(0), 2)
    assert solution.extra < 1
    assert solution.starts > 3  # the search with all of the gaps counts too
    assert is_feasible(replace(task, extra=None), solution.centres)


def test_an_object_allowed_nowhere_is_named():
    with pytest.raises(InfeasibleScene, match="cup"):
        solve(squares([(0, 0)], allowed=(np.empty((0, 2, 2)),)), ["cup"], CostWeights(), np.random.default_rng(0), 2)
