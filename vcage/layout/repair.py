"""The exact side of the layout's optimisation: is it free of collisions, and if not, which few moves make it so."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vcage.layout.cost import LayoutProblem, penetrations
from vcage.layout.placement.free_region import free_region

TOLERANCE = 1e-8
"""Metres below which a layout counts as exact."""


def is_feasible(problem: LayoutProblem, centres: np.ndarray) -> bool:
    """The exact check: all gaps at least the margin, all footprints in bounds, all centres where they may be."""
    return not np.any(penetrations(problem, centres) > TOLERANCE) and bool(np.all(_at_home(problem, centres)))


def repair(problem: LayoutProblem, centres: np.ndarray, tries: int = 1) -> tuple[np.ndarray, tuple[int, ...]] | None:
    """Move as few and as small footprints as needed to their nearest free points, exactly.

    Fixed items stay, then the largest first; each one in the way of those before it moves. Where one finds
    no free point, it goes before all movable ones and the repair starts again, ``tries`` times in all: hard
    items are placed early.

    Returns:
        The repaired centres (n, 2) and the indices of the moved ones; None when no try found places for all.
    """
    order = [int(k) for k in np.argsort(-problem.half.prod(axis=1), kind="stable")]
    order.sort(key=lambda k: problem.movable[k])
    first = int((~problem.movable).sum())
    for _ in range(tries):
        repaired, stuck = _repair_in(order, problem, centres)
        if stuck is None:
            moved = np.flatnonzero(np.abs(repaired - centres).max(axis=1) > TOLERANCE)
            return (repaired, tuple(int(k) for k in moved)) if is_feasible(problem, repaired) else None
        if stuck == order[first]:
            return None
        order.remove(stuck)
        order.insert(first, stuck)
    return None


def _repair_in(order: Sequence[int], problem: LayoutProblem, centres: np.ndarray) -> tuple[np.ndarray, int | None]:
    """The centres with each footprint in ``order`` moved out of the way of those before; the first without a place."""
    fixed, kept = centres.copy(), []
    home = _at_home(problem, centres)
    x, y = problem.distances
    for k in order:
        apart = np.abs(fixed[kept] - fixed[k])
        if not home[k] or np.any((apart[:, 0] < x[k, kept] - TOLERANCE) & (apart[:, 1] < y[k, kept] - TOLERANCE)):
            half = problem.half[kept]
            taken = np.stack([fixed[kept] - half, fixed[kept] + half], axis=1)
            allowed = problem.allowed[k]
            unions = () if allowed is None else (allowed,)
            region = free_region(problem.bounds, problem.half[k], taken, problem.gaps(k, kept), unions)
            if region.is_empty:
                return fixed, k
            fixed[k] = region.nearest(fixed[k])
        kept.append(k)
    return fixed, None


def _at_home(problem: LayoutProblem, centres: np.ndarray) -> np.ndarray:
    """(n,) bool: in the bounds, and where the centre is allowed."""
    lower, upper = problem.centre_bounds
    home = np.all((centres >= lower - TOLERANCE) & (centres <= upper + TOLERANCE), axis=1)
    rows, rectangles = problem.reachable
    if len(rows):
        at = centres[rows][:, None]
        inside = (at >= rectangles[:, :, 0] - TOLERANCE) & (at <= rectangles[:, :, 1] + TOLERANCE)
        home[rows] &= inside.all(axis=2).any(axis=1)
    return home
