"""One plane of footprints brought to a collision-free layout near its targets.

L-BFGS-B from the targets and from random restarts; violations below its precision are repaired exactly. Of the
feasible layouts the one with the most satisfied relations wins, and among those the one that moves least.
Starting ends when the plan is kept and another start brings nothing. Where no start becomes feasible, wider gaps are
given up, then harder repairs are tried, then a layout packed by :func:`vcage.layout.placement.place.place` is pulled
back towards the targets; if there is none, its error says why.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vcage.base.workers import one_blas_thread
from vcage.layout.cost import CostWeights, LayoutProblem
from vcage.layout.descent import STAGES, descend, tightened
from vcage.layout.items import TableItem
from vcage.layout.placement.place import place, require_possible
from vcage.layout.repair import is_feasible, repair


@dataclass(frozen=True)
class SolverSettings:
    """Settings of the starts of one problem.

    Args:
        spread_m: standard deviation of the first random restart; each one is twice as wide as the one before.
        widest_m: standard deviation that no restart exceeds.
        jitter_m: moves objects with the same target apart: coinciding centres have no gradient.
        patience: starts in a row without improvement before a layout is taken that keeps the plan, but that the repair
            had to change. An unrepaired one is taken immediately: it is a local minimum near the targets already.
        gain_share: of the best displacement cost that a start must fall below to count as an improvement.
        repair_orders: number of orders tried when no start became feasible.
        eased_shares: of the wider gaps, tried when there is no layout with all of them.
    """

    spread_m: float = 0.01
    widest_m: float = 0.1
    jitter_m: float = 1e-4
    patience: int = 2
    gain_share: float = 0.95
    repair_orders: int = 40
    eased_shares: tuple[float, ...] = (0.5, 0.0)


SETTINGS = SolverSettings()


@dataclass(frozen=True)
class Solution:
    """A feasible layout.

    Args:
        centres: (n, 2) metres.
        starts: how many descents were run, with all gaps and with eased ones; 0 where the target was feasible, or one
            alone took the nearest place.
        repaired: names of the footprints that the exact repair moved.
        extra: share of the problem's wider gaps that was kept.
    """

    centres: np.ndarray
    starts: int
    repaired: tuple[str, ...]
    extra: float = 1.0


def solve(
    problem: LayoutProblem, names: Sequence[str], weights: CostWeights, rng: np.random.Generator, restarts: int
) -> Solution:
    """The best feasible layout of all starts.

    Raises:
        InfeasibleScene: none was found; names the objects and the area that is missing.
    """
    if _is_hopeless(problem):
        require_possible(_as_items(problem, names), problem.bounds, problem.margin, _fixed_boxes(problem))
    if weights.relation == 0:
        problem = replace(problem, relations=None)
    if is_feasible(problem, problem.target) and not _broken(problem, problem.target):
        return Solution(problem.target.copy(), 0, ())
    if len(names) == 1 and problem.relations is None and (alone := repair(problem, problem.target)) is not None:
        return Solution(alone[0], 0, tuple(names[k] for k in alone[1]))
    with one_blas_thread():
        return _searched(problem, names, weights, rng, restarts)


def _searched(
    problem: LayoutProblem, names: Sequence[str], weights: CostWeights, rng: np.random.Generator, restarts: int
) -> Solution:
    """The best layout of all starts, with as much of the wider gaps as there is a layout for."""
    wider = problem.extra
    eased = [] if wider is None else [(share, replace(problem, extra=share * wider)) for share in SETTINGS.eased_shares]
    search, share = _Search(problem, names, weights, rng), 1.0
    while not search.run(restarts):
        if not eased:
            if not search.repair_harder():
                search.pack()
            break
        share, problem = eased.pop(0)
        search = _Search(problem, names, weights, rng, search.starts)
    return search.solution(share)


class _Search:
    """The starts of one problem, and the best feasible layout that they led to.

    Attributes:
        starts: number of descents, with those of the earlier searches.
    """

    def __init__(
        self,
        problem: LayoutProblem,
        names: Sequence[str],
        weights: CostWeights,
        rng: np.random.Generator,
        starts: int = 0,
    ):
        self._problem, self._tight, self._weights, self._rng = problem, tightened(problem), weights, rng
        self._names = names
        # The broken relations and the displacement cost, which order feasible layouts; centres; what was repaired.
        self._best: tuple[tuple[int, float], np.ndarray, tuple[int, ...]] | None = None
        self.starts = starts
        self._ends: list[np.ndarray] = []  # the ends of all starts, feasible or not

    def solution(self, share: float) -> Solution:
        """The best layout; there must be one."""
        assert self._best is not None, "no layout was found"
        _, centres, moved = self._best
        return Solution(centres, self.starts, tuple(self._names[k] for k in moved), share)

    def run(self, restarts: int) -> bool:
        """Start from the targets, then from wider and wider around them; True if a feasible layout was found."""
        idle = 0
        for start in range(restarts + 1):
            spread = min(SETTINGS.spread_m * 2 ** (start - 1), SETTINGS.widest_m) if start else SETTINGS.jitter_m
            noise = self._rng.normal(0, spread, self._problem.target.shape)
            self._ends.append(self._descend(self._tight, self._problem.target + noise))
            gained = self._offer(repair(self._problem, self._ends[-1]))
            idle = 0 if gained else idle + 1
            if self._best is not None and self._best[0][0] == 0 and (idle >= SETTINGS.patience or not self._best[2]):
                return True
        if self._best is not None and self._best[0][0]:
            self._give_up_relations(self._best[1])
        return self._best is not None

    def _descend(self, tight: LayoutProblem, start: np.ndarray, stages: Sequence[float] = STAGES) -> np.ndarray:
        self.starts += 1
        return descend(tight, self._weights, start, stages)

    def _offer(self, repaired: tuple[np.ndarray, tuple[int, ...]] | None) -> bool:
        """Keep a layout if it is the best; True if it is better by more than a little."""
        if repaired is None:
            return False
        score = _broken(self._problem, repaired[0]), _displacement(self._problem, repaired[0])
        before = self._best[0] if self._best else None
        if before is None or score < before:
            self._best = (score, *repaired)
        return before is None or score < (before[0], SETTINGS.gain_share * before[1])

    def _give_up_relations(self, centres: np.ndarray) -> None:
        """Relations that cannot all hold pull at each other: leave out the worst, one at a time, and go on."""
        relations = self._tight.relations
        while relations is not None and len(relations) > 1 and (missed := relations.violations(centres)).max() > 0:
            relations = relations.without(int(missed.argmax()))
            centres = self._descend(replace(self._tight, relations=relations), centres)
            self._offer(repair(self._problem, centres))

    def repair_harder(self) -> bool:
        """For problems that no start solved: many orders of repair, and back towards the targets."""
        for end in self._ends:
            if (repaired := repair(self._problem, end, SETTINGS.repair_orders)) is not None:
                self._offer(repaired)
                self._pull_back(repaired[0])
                return True
        return False

    def _pull_back(self, centres: np.ndarray) -> None:
        """From a layout that repair or packing took far away, towards the targets."""
        self._offer(repair(self._problem, self._descend(self._tight, centres, STAGES[-1:])))

    def pack(self) -> None:
        """A packed layout, pulled back towards the targets.

        Raises:
            InfeasibleScene: there is none.
        """
        problem, names = self._problem, self._names
        items = _as_items(problem, names)
        placed = place(items, problem.bounds, self._rng, problem.margin, _fixed_boxes(problem))
        packed = problem.target.copy()
        for k in np.flatnonzero(problem.movable):
            packed[k] = placed[names[k]].x, placed[names[k]].y
        self._offer((packed, tuple(int(k) for k in np.flatnonzero(problem.movable))))
        self._pull_back(packed)


def _broken(problem: LayoutProblem, centres: np.ndarray) -> int:
    return 0 if problem.relations is None else problem.relations.broken(centres)


def _displacement(problem: LayoutProblem, centres: np.ndarray) -> float:
    return float((problem.weight[:, None] * (centres - problem.target) ** 2).sum())


def _is_hopeless(problem: LayoutProblem) -> bool:
    """True if a footprint is larger than the bounds, has no reachable place, or all together take too much area."""
    room = problem.bounds[1] - problem.bounds[0]
    half = problem.half[problem.movable]
    grown = (2 * half + problem.margin).prod(axis=1).sum()
    too_large = np.any(2 * half > room) or grown > (room + problem.margin).prod()
    return bool(too_large) or any(allowed is not None and not len(allowed) for allowed in problem.allowed)


def _fixed_boxes(problem: LayoutProblem) -> np.ndarray:
    """(k, 2, 2) rectangles of the fixed footprints."""
    at, half = problem.target[~problem.movable], problem.half[~problem.movable]
    return np.stack([at - half, at + half], axis=1)


def _as_items(problem: LayoutProblem, names: Sequence[str]) -> list[TableItem]:
    """The movable footprints as items for a placement."""
    # No height matters in a plane.
    return [
        TableItem(
            names[k], (float(2 * problem.half[k, 0]), float(2 * problem.half[k, 1]), 1.0), allowed=problem.allowed[k]
        )
        for k in np.flatnonzero(problem.movable)
    ]
