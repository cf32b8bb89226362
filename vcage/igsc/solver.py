"""One plane of footprints brought to a collision-free layout near its targets.

L-BFGS-B from the targets and from random restarts; what it leaves below its precision is repaired exactly, and the
feasible layout that moves the least wins. If no start becomes feasible, a layout packed by
:func:`vcage.igsc.place.place` is pulled back towards the targets; if there is none, that says why.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize
from threadpoolctl import threadpool_limits

from vcage.igsc.cost import LayoutProblem, Weights, evaluate, penetrations
from vcage.igsc.free_region import free_region
from vcage.igsc.place import PlaceItem, place, require_possible

SLACK = 5e-4
"""Metres by which margin and limits are tightened while solving, to absorb what the penalties leave."""
STAGES = (0.01, 1.0)
"""Shares of the collision weight, one after the other: while it is low, objects pass through each other to the nearer
side. Over 24 random layouts of 6-40 objects this leaves 0.3-0.7 of the displacement cost of a single stage."""
ITERATIONS = 120
"""L-BFGS-B iterations for each stage; the exact repair mends what they leave."""
TOLERANCE = 1e-8
"""Metres below which a layout counts as exact."""
SPREAD = 0.03
"""Standard deviation of the first random restart, metres; the k-th is k times as wide."""
JITTER = 1e-4
"""Moves objects with the same target apart: coinciding centres have no gradient."""


@dataclass(frozen=True)
class Solution:
    """A feasible layout.

    Args:
        centres: (n, 2) metres.
        starts: how many starts were optimised.
        feasible: how many of them became feasible.
        repaired: indices of the footprints that the exact repair moved.
    """

    centres: np.ndarray
    starts: int
    feasible: int
    repaired: tuple[int, ...]


def solve(
    problem: LayoutProblem, names: Sequence[str], weights: Weights, rng: np.random.Generator, restarts: int
) -> Solution:
    """The feasible layout that is nearest to the targets, by area-weighted squares, of all starts.

    Raises:
        InfeasibleScene: none was found; names the objects and the area that is missing.
    """
    items = _as_place_items(problem, names)
    require_possible(items, problem.bounds, problem.margin)
    if is_feasible(problem, problem.target):
        return Solution(problem.target.copy(), 0, 0, ())
    found = []
    for start in range(restarts + 1):
        spread = start * SPREAD or JITTER
        centres = _minimise(problem, weights, problem.target + rng.normal(0, spread, problem.target.shape))
        repaired = repair(problem, centres)
        if repaired is not None:
            found.append(repaired)
    if not found:
        found = [_packed(problem, items, weights, rng)]
        return Solution(found[0][0], restarts + 2, 0, found[0][1])
    best = min(found, key=lambda layout: _displacement(problem, layout[0]))
    return Solution(best[0], restarts + 1, len(found), best[1])


def is_feasible(problem: LayoutProblem, centres: np.ndarray) -> bool:
    """The exact check: all gaps at least the margin, all footprints in bounds, all centres where they may be."""
    _, _, depth = penetrations(problem, centres)
    apart = not np.any(np.all(depth > TOLERANCE, axis=1))
    cost, _ = evaluate(problem, Weights(), centres)
    return apart and max(cost.boundary, cost.reach) <= TOLERANCE**2


def repair(problem: LayoutProblem, centres: np.ndarray) -> tuple[np.ndarray, tuple[int, ...]] | None:
    """Move as few and as small footprints as needed to their nearest free points, exactly.

    The largest stay first; each one that is in the way of those before it moves. None when one finds no free point.
    """
    fixed, moved = centres.copy(), []
    kept: list[int] = []
    for k in np.argsort(-problem.half.prod(axis=1), kind="stable"):
        taken = np.stack([fixed[kept] - problem.half[kept], fixed[kept] + problem.half[kept]], axis=1)
        region = free_region(problem.bounds, problem.half[k], taken, problem.gaps(int(k), kept), problem.allowed[k])
        if region.is_empty:
            return None
        nearest = region.nearest(fixed[k])
        if np.abs(nearest - fixed[k]).max() > TOLERANCE:
            moved.append(int(k))
        fixed[k] = nearest
        kept.append(int(k))
    return (fixed, tuple(moved)) if is_feasible(problem, fixed) else None


def _minimise(problem: LayoutProblem, weights: Weights, start: np.ndarray) -> np.ndarray:
    """(n, 2) a local minimum of the cost with a slightly larger margin, inside the bounds."""
    tight = replace(problem, margin=problem.margin + SLACK, allowed=tuple(_shrunk(a) for a in problem.allowed))
    lower, upper = problem.centre_bounds()
    # An exact fit may be an empty interval by the last bit.
    lower, upper = np.minimum(lower, upper), np.maximum(lower, upper)

    centres = np.clip(start, lower, upper)
    # BLAS threads cost more than they give on matrices this small
    with threadpool_limits(limits=1, user_api="blas"):
        return _descend(tight, weights, centres, lower, upper)


def _descend(
    tight: LayoutProblem, weights: Weights, centres: np.ndarray, lower: np.ndarray, upper: np.ndarray
) -> np.ndarray:
    """L-BFGS-B with the collision weight raised in stages."""
    for share in STAGES:
        staged = replace(weights, collision=share * weights.collision)

        def objective(flat: np.ndarray, staged: Weights = staged) -> tuple[float, np.ndarray]:
            cost, gradient = evaluate(tight, staged, flat.reshape(-1, 2))
            return cost.total, gradient.ravel()

        centres = minimize(
            objective,
            centres.ravel(),
            jac=True,
            method="L-BFGS-B",
            bounds=np.stack([lower.ravel(), upper.ravel()], axis=1),
            options={"maxiter": ITERATIONS, "ftol": 1e-9, "gtol": 1e-9},
        ).x.reshape(-1, 2)
    return centres


def _shrunk(rectangles: np.ndarray | None) -> np.ndarray | None:
    """Rectangles made smaller by the slack on all sides, down to their middle line."""
    if rectangles is None:
        return None
    by = np.minimum(SLACK, (rectangles[:, 1] - rectangles[:, 0]) / 2)
    return np.stack([rectangles[:, 0] + by, rectangles[:, 1] - by], axis=1)


def _packed(
    problem: LayoutProblem, items: list[PlaceItem], weights: Weights, rng: np.random.Generator
) -> tuple[np.ndarray, tuple[int, ...]]:
    """A packed layout, pulled back towards the targets where that stays feasible; packing gives up extra gaps."""
    placed = place(items, problem.bounds, rng, problem.margin)
    packed = np.array([[placement.x, placement.y] for placement in placed.values()])
    return repair(problem, _minimise(problem, weights, packed)) or (packed, tuple(range(len(packed))))


def _displacement(problem: LayoutProblem, centres: np.ndarray) -> float:
    return evaluate(problem, Weights(), centres)[0].displacement


def _as_place_items(problem: LayoutProblem, names: Sequence[str]) -> list[PlaceItem]:
    return [
        PlaceItem(name, (float(2 * half[0]), float(2 * half[1])), allowed=allowed)
        for name, half, allowed in zip(names, problem.half, problem.allowed, strict=True)
    ]
