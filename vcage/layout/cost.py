"""The cost of a layout (paper, equation 1) and its analytic gradient.

J(x) = λc·J_coll + λd·J_disp + λb·J_bnd (+ λr·J_reach + λp·J_plan), over the centres x (n, 2) of n footprints:

- J_coll: for every pair, with the penetrations p_x and p_y of their boxes grown by the margin δ, both positive,
  p_x²·p_y² / (p_x² + p_y²): about the square of the smaller one, the way out, and smooth where they are equal.
- J_disp: Σ w_i·|x_i − t_i|², the weight w_i proportional to the footprint's area, 1 on average.
- J_bnd: the squared distance by which boxes stick out of the workspace.
- J_reach: the squared distance of each centre to the rectangles that it is allowed in, where it has any.
- J_plan: violations of the plan's relations, :mod:`vcage.layout.relation_cost`.

The last two are not in the paper. Terms constant in x are computed once for each problem.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vcage.base.errors import UsageError
from vcage.layout.relation_cost import RelationTerms


@dataclass(frozen=True)
class CostWeights:
    """The λ of the equation; only their ratios matter.

    Args:
        collision: a pair pulled together by targets d metres apart overlaps by d / 1000, so that a displacement of
            10 cm leaves 0.1 mm, less than the tightening of the margin while solving. More only makes it stiff.
        displacement: the unit.
        boundary: as the collision: sticking out and overlapping are equally impossible. It decides nothing here, as
            L-BFGS-B keeps all centres within their bounds and the term at 0; only a layout from elsewhere, such as
            the targets, has any of it.
        reach: as the collision: an object out of the arm's reach has no task.
        relation: for each relation of the plan; 500 leaves a displacement of 20 cm less than half a millimetre, below
            the tightening of relations while solving. Its pull is bounded by the knee to that of a collision of
            2.5 mm: more than any displacement has, less than two touching objects. 0 turns the relations off, except
            for planned contents.

    Raises:
        UsageError: one is negative or not finite.
    """

    collision: float = 1000.0
    displacement: float = 1.0
    boundary: float = 1000.0
    reach: float = 1000.0
    relation: float = 500.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value >= 0):
                raise UsageError(f"the weight of {name} is {value}", hint="weights are finite numbers, 0 or more")


@dataclass(frozen=True)
class LayoutProblem:
    """Footprints on one plane.

    Args:
        half: (n, 2) half sizes of the axis-aligned footprints, metres.
        target: (n, 2) where the centres should be.
        bounds: (2, 2) lower and upper corner that every footprint must stay within.
        margin: δ, smallest gap between two footprints, metres: objects that settle by some millimetres must not touch,
            and objects to grasp need room for a finger beside them.
        allowed: for each footprint (m, 2, 2) rectangles for its centre, or None.
        extra: (n, n) symmetric, extra gap of a pair beyond the margin, metres; none when left out.
        relations: the plan's relations between them, or None.
        fixed: (n,) bool, footprints that stay at their targets, even if they touch each other; none when left out.
    """

    half: np.ndarray
    target: np.ndarray
    bounds: np.ndarray
    margin: float
    allowed: tuple[np.ndarray | None, ...]
    extra: np.ndarray | None = None
    relations: RelationTerms | None = None
    fixed: np.ndarray | None = None

    @cached_property
    def movable(self) -> np.ndarray:
        """(n,) bool."""
        return np.ones(len(self.half), dtype=bool) if self.fixed is None else ~self.fixed

    def gaps(self, i: int, j: np.ndarray | list[int]) -> np.ndarray:
        """(len(j),) the smallest gaps between footprint i and footprints j."""
        return self.margin + (np.zeros(len(j)) if self.extra is None else self.extra[i, j])

    @cached_property
    def weight(self) -> np.ndarray:
        """(n,) displacement weights: area over mean area."""
        area = self.half.prod(axis=1)
        return area / area.mean()

    @cached_property
    def distances(self) -> np.ndarray:
        """(2, n, n) along each axis, how far apart centres are when their gap is just kept; −1 where none is to be."""
        distances = self.half.T[:, :, None] + self.half.T[:, None, :] + self.margin
        if self.extra is not None:
            distances += self.extra
        distances[:, range(len(self.half)), range(len(self.half))] = -1.0
        if self.fixed is not None:
            distances[:, np.outer(self.fixed, self.fixed)] = -1.0
        return distances

    @cached_property
    def centre_bounds(self) -> np.ndarray:
        """(2, n, 2) lowest and highest centres that keep each footprint in the bounds."""
        within = np.stack([self.bounds[0] + self.half, self.bounds[1] - self.half])
        return within if self.fixed is None else np.where(self.fixed[:, None], self.target, within)

    @cached_property
    def reachable(self) -> tuple[np.ndarray, np.ndarray]:
        """(k,) the footprints that are not allowed anywhere, and (k, m, 2, 2) their rectangles, the last repeated."""
        bound = {k: allowed for k, allowed in enumerate(self.allowed) if allowed is not None}
        most = max(map(len, bound.values()), default=0)
        padded = [np.pad(allowed, ((0, most - len(allowed)), (0, 0), (0, 0)), "edge") for allowed in bound.values()]
        return np.array(list(bound), dtype=int), np.array(padded).reshape(len(bound), most, 2, 2)


@dataclass(frozen=True)
class Cost:
    """The unweighted terms, and J: the terms times their λ; metres²."""

    collision: float
    displacement: float
    boundary: float
    reach: float
    relation: float
    total: float


def evaluate(problem: LayoutProblem, weights: CostWeights, centres: np.ndarray) -> tuple[Cost, np.ndarray]:
    """The terms at ``centres`` (n, 2), and the gradient (n, 2) of J."""
    terms = (
        (weights.collision, _collision(problem, centres)),
        (weights.displacement, _displacement(problem, centres)),
        (weights.boundary, _boundary(problem, centres)),
        (weights.reach, _reach(problem, centres)),
        (weights.relation, _relation(problem, centres)),
    )
    total = sum(weight * value for weight, (value, _) in terms)
    slopes = (weight * slope for weight, (_, slope) in terms if slope is not None)
    return Cost(*(value for _, (value, _) in terms), total=total), sum(slopes, start=np.zeros_like(centres))


def penetrations(problem: LayoutProblem, centres: np.ndarray) -> np.ndarray:
    """(n, n) penetration of every pair along the axis of the smaller one, with the margin; ≤ 0 is apart."""
    return np.minimum(*_depths(problem, centres)[1])


def _depths(problem: LayoutProblem, centres: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two (2, n, n): the ways between all centres, and how much shorter they are than they should be."""
    across = centres.T[:, :, None] - centres.T[:, None, :]
    return across, problem.distances - np.abs(across)


_Term = tuple[float, np.ndarray | None]
"""A value and its gradient (n, 2); None stands for zeros."""


def _collision(problem: LayoutProblem, centres: np.ndarray) -> _Term:
    across, depths = _depths(problem, centres)
    hit = np.flatnonzero(np.minimum(depths[0], depths[1]) > 0)  # every pair twice
    if not hit.size:
        return 0.0, None
    n = len(centres)
    depth = depths.reshape(2, -1)[:, hit]
    squared = depth * depth
    share = squared[::-1] / (squared[0] + squared[1])
    # d(ab / (a + b)) / da = (b / (a + b))², with a = p_x², da / dx_i = −2·p_x·sign(x_i − x_j)
    slope = -2 * share * share * np.copysign(depth, across.reshape(2, -1)[:, hit])
    row = hit // n
    gradient = np.stack([np.bincount(row, slope[0], n), np.bincount(row, slope[1], n)], axis=1)
    return float(squared[0] @ share[0]) / 2, gradient


def _displacement(problem: LayoutProblem, centres: np.ndarray) -> _Term:
    offset = centres - problem.target
    pull = problem.weight[:, None] * offset
    return float(np.vdot(pull, offset)), 2 * pull


def _boundary(problem: LayoutProblem, centres: np.ndarray) -> _Term:
    lower, upper = problem.centre_bounds
    excess = centres - np.minimum(np.maximum(centres, lower), upper)
    if not excess.any():
        return 0.0, None
    return float(np.vdot(excess, excess)), 2 * excess


def _reach(problem: LayoutProblem, centres: np.ndarray) -> _Term:
    rows, rectangles = problem.reachable
    if not len(rows):
        return 0.0, None
    at = centres[rows][:, None]  # (k, 1, 2)
    ways = at - np.minimum(np.maximum(at, rectangles[:, :, 0]), rectangles[:, :, 1])  # (k, m, 2)
    nearest = (ways * ways).sum(axis=2).argmin(axis=1)
    offset = np.zeros_like(centres)
    offset[rows] = ways[np.arange(len(rows)), nearest]
    return float((offset**2).sum()), 2 * offset


def _relation(problem: LayoutProblem, centres: np.ndarray) -> _Term:
    if problem.relations is None:
        return 0.0, None
    return problem.relations.cost(centres)
