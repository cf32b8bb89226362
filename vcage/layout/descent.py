"""L-BFGS-B on the cost of a layout, from one start (paper, section III-A4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize

from vcage.layout.cost import CostWeights, LayoutProblem, evaluate

SLACK = 5e-4
"""Metres by which margin and limits are tightened while solving, to absorb what the penalties leave."""
RELATION_SLACK = 2e-3
"""Metres by which relations are held better than they need, to absorb that and what settling moves."""
STAGES = (0.01, 1.0)
"""Shares of the collision weight, one after the other: while it is low, objects pass through each other to the nearer
side, which a single stiff stage does not let them."""
ITERATIONS = 120
"""L-BFGS-B iterations for each stage; the exact repair fixes what they leave."""
PRECISION = 1e-5
"""Relative change of the cost at which a stage ends: what is left below it is less than what one local minimum differs
from the next, and the repair is exact from anywhere near."""


def tightened(problem: LayoutProblem) -> LayoutProblem:
    """The problem with margin, limits and relations tightened by what penalties may leave."""
    return replace(
        problem,
        margin=problem.margin + SLACK,
        allowed=tuple(_shrunk(a) for a in problem.allowed),
        relations=None if problem.relations is None else problem.relations.tightened(RELATION_SLACK),
    )


def descend(
    tight: LayoutProblem, weights: CostWeights, start: np.ndarray, stages: Sequence[float] = STAGES
) -> np.ndarray:
    """(n, 2) a local minimum of the cost near a start, within the bounds.

    Args:
        tight: from :func:`tightened`.
        weights: the λ of the equation.
        start: (n, 2) metres.
        stages: shares of the collision weight.
    """
    lower, upper = tight.centre_bounds
    # An exact fit may be an empty interval by the last bit.
    lower, upper = np.minimum(lower, upper).ravel(), np.maximum(lower, upper).ravel()
    flat = np.clip(start.ravel(), lower, upper)
    for share in stages:
        staged = replace(weights, collision=share * weights.collision)

        def objective(flat: np.ndarray, staged: CostWeights = staged) -> tuple[float, np.ndarray]:
            cost, gradient = evaluate(tight, staged, flat.reshape(-1, 2))
            return cost.total, gradient.ravel()

        flat = minimize(
            objective,
            flat,
            jac=True,
            method="L-BFGS-B",
            bounds=np.stack([lower, upper], axis=1),
            options={"maxiter": ITERATIONS, "ftol": PRECISION, "gtol": 1e-9},
        ).x
    return flat.reshape(-1, 2)


def _shrunk(rectangles: np.ndarray | None) -> np.ndarray | None:
    """Rectangles made smaller by the slack on all sides, down to their middle line."""
    if rectangles is None:
        return None
    by = np.minimum(SLACK, (rectangles[:, 1] - rectangles[:, 0]) / 2)
    return np.stack([rectangles[:, 0] + by, rectangles[:, 1] - by], axis=1)
