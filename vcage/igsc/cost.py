"""The cost of a layout (paper, equation 1) and its analytic gradient.

J(x) = λc·J_coll + λd·J_disp + λb·J_bnd (+ λr·J_reach), over the centres x (n, 2) of n footprints:

- J_coll: for every pair, with the penetrations p_x and p_y of their boxes grown by the margin δ, both positive,
  p_x²·p_y² / (p_x² + p_y²): about the square of the smaller one, the way out, and smooth where they are equal.
- J_disp: Σ w_i·|x_i − t_i|², the weight w_i proportional to the footprint's area, 1 on average.
- J_bnd: the squared distance by which boxes stick out of the workspace.
- J_reach: the squared distance of each centre to the rectangles that it is allowed in, where it has any.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vcage.igsc.free_region import nearest_in_rectangles


@dataclass(frozen=True)
class Weights:
    """The λ of the equation. What must not happen weighs so much that displacement leaves it below a millimetre."""

    collision: float = 1000.0
    displacement: float = 1.0
    boundary: float = 1000.0
    reach: float = 1000.0


@dataclass(frozen=True)
class LayoutProblem:
    """Footprints on one plane.

    Args:
        half: (n, 2) half sizes of the axis-aligned footprints, metres.
        target: (n, 2) where the centres should be.
        bounds: (2, 2) lower and upper corner that every footprint must stay within.
        margin: δ, smallest gap between two footprints.
        allowed: for each footprint (m, 2, 2) rectangles for its centre, or None.
        extra: (n, n) symmetric, what a pair's gap is wider than the margin, metres; none when left out.
    """

    half: np.ndarray
    target: np.ndarray
    bounds: np.ndarray
    margin: float
    allowed: tuple[np.ndarray | None, ...]
    extra: np.ndarray | None = None

    def gaps(self, i: np.ndarray | int, j: np.ndarray | list[int]) -> np.ndarray:
        """The smallest gaps of the pairs (i, j)."""
        return self.margin + (np.zeros(len(j)) if self.extra is None else self.extra[i, j])

    @property
    def weight(self) -> np.ndarray:
        """(n,) displacement weights: area over mean area."""
        area = self.half.prod(axis=1)
        return area / area.mean()

    def centre_bounds(self) -> np.ndarray:
        """(2, n, 2) lowest and highest centres that keep each footprint in the bounds."""
        return np.stack([self.bounds[0] + self.half, self.bounds[1] - self.half])


@dataclass(frozen=True)
class Cost:
    """The unweighted terms, and J: the terms times their λ; metres²."""

    collision: float
    displacement: float
    boundary: float
    reach: float
    total: float


def evaluate(problem: LayoutProblem, weights: Weights, centres: np.ndarray) -> tuple[Cost, np.ndarray]:
    """The terms at ``centres`` (n, 2), and the gradient (n, 2) of J."""
    collision, d_collision = _collision(problem, centres)
    displacement, d_displacement = _displacement(problem, centres)
    boundary, d_boundary = _boundary(problem, centres)
    reach, d_reach = _reach(problem, centres)
    gradient = (
        weights.collision * d_collision
        + weights.displacement * d_displacement
        + weights.boundary * d_boundary
        + weights.reach * d_reach
    )
    total = (
        weights.collision * collision
        + weights.displacement * displacement
        + weights.boundary * boundary
        + weights.reach * reach
    )
    return Cost(collision, displacement, boundary, reach, total), gradient


def penetrations(problem: LayoutProblem, centres: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(pairs,) indices i and j, i < j, and (pairs, 2) penetration along each axis with the margin; ≤ 0 is apart."""
    i, j = np.triu_indices(len(centres), k=1)
    reach = problem.half[i] + problem.half[j] + problem.gaps(i, j)[:, None]
    return i, j, reach - np.abs(centres[i] - centres[j])


def _collision(problem: LayoutProblem, centres: np.ndarray) -> tuple[float, np.ndarray]:
    i, j, depth = penetrations(problem, centres)
    hit = np.all(depth > 0, axis=1)
    i, j, depth = i[hit], j[hit], depth[hit]
    squared = depth**2
    total = squared.sum(axis=1)
    value = squared.prod(axis=1) / total
    # d(ab / (a + b)) / da = (b / (a + b))², with a = p_x², da / dx_i = −2·p_x·sign(x_i − x_j)
    slope = (squared[:, ::-1] / total[:, None]) ** 2 * -2 * depth * np.sign(centres[i] - centres[j])
    gradient = np.zeros_like(centres)
    np.add.at(gradient, i, slope)
    np.add.at(gradient, j, -slope)
    return float(value.sum()), gradient


def _displacement(problem: LayoutProblem, centres: np.ndarray) -> tuple[float, np.ndarray]:
    offset, weight = centres - problem.target, problem.weight[:, None]
    return float((weight * offset**2).sum()), 2 * weight * offset


def _boundary(problem: LayoutProblem, centres: np.ndarray) -> tuple[float, np.ndarray]:
    lower, upper = problem.centre_bounds()
    excess = np.maximum(centres - upper, 0) - np.maximum(lower - centres, 0)
    return float((excess**2).sum()), 2 * excess


def _reach(problem: LayoutProblem, centres: np.ndarray) -> tuple[float, np.ndarray]:
    offset = np.zeros_like(centres)
    for k, allowed in enumerate(problem.allowed):
        if allowed is not None:
            offset[k] = centres[k] - nearest_in_rectangles(centres[k], allowed)
    return float((offset**2).sum()), 2 * offset
