"""What most would write: L-BFGS-B on the same cost from the targets, with scipy's own finite differences."""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize

from vcage.igsc.layout.cost import LayoutProblem, Weights
from vcage.igsc.placement.free_region import nearest_in_rectangles


def finite_differences(problem: LayoutProblem, weights: Weights) -> np.ndarray:
    """(n, 2) centres after one start with scipy's default options; nothing is repaired."""
    value = PlainCost(problem, weights)
    # What is wider than an opening has its lowest centre above its highest.
    lower, upper = np.minimum(*value.bounds), np.maximum(*value.bounds)
    solution = minimize(
        lambda flat: value(flat.reshape(-1, 2)),
        np.clip(problem.target, lower, upper).ravel(),
        method="L-BFGS-B",
        bounds=np.stack([lower.ravel(), upper.ravel()], axis=1),
    )
    return solution.x.reshape(-1, 2)


class PlainCost:
    """J of :mod:`vcage.igsc.layout.cost` without its gradient, so that the rival does not pay for what it does not use.

    Every pair has the same margin. Only the plan's term makes its gradient too: it is small beside the pairs.
    """

    def __init__(self, problem: LayoutProblem, weights: Weights):
        self._problem, self._weights = problem, weights
        self._i, self._j = np.triu_indices(len(problem.half), k=1)
        self._reach = problem.half[self._i] + problem.half[self._j] + problem.margin
        self._area = problem.weight
        self.bounds = problem.bounds[0] + problem.half, problem.bounds[1] - problem.half
        self._allowed = [(k, a) for k, a in enumerate(problem.allowed) if a is not None]

    def __call__(self, centres: np.ndarray) -> float:
        """J at ``centres`` (n, 2), metres²."""
        depth = self._reach - np.abs(centres[self._i] - centres[self._j])
        squared = depth[(depth > 0).all(axis=1)] ** 2
        collision = (squared.prod(axis=1) / squared.sum(axis=1)).sum()
        displacement = (self._area * ((centres - self._problem.target) ** 2).sum(axis=1)).sum()
        lower, upper = self.bounds
        boundary = ((np.maximum(centres - upper, 0) + np.maximum(lower - centres, 0)) ** 2).sum()
        reach = sum(((centres[k] - nearest_in_rectangles(centres[k], a)) ** 2).sum() for k, a in self._allowed)
        w, plan = self._weights, self._problem.relations
        planned = w.relation * plan.cost(centres)[0] if plan is not None else 0.0
        return planned + float(
            w.collision * collision + w.displacement * displacement + w.boundary * boundary + w.reach * reach
        )
