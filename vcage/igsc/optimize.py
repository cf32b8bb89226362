"""Collision-free placement optimisation with containers as groups (paper, section III-A4).

Contents are optimised together in the frame of their container, innermost containers first; then every container
is moved as a rigid body with what it holds. Support heights follow: table top, container floor.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vcage.errors import InfeasibleScene
from vcage.igsc.containers import LayoutItem, assign_containers, validate_items
from vcage.igsc.cost import Cost, LayoutProblem, Weights, evaluate
from vcage.igsc.solver import Solution, solve

log = logging.getLogger(__name__)

PALM_ABOVE = 0.05
"""Things lower than this pass under the palm of a hand that grasps what lies beside them, metres."""

PALM_ROOM = 0.095
"""Gap that a hand needs between what it grasps and what is higher: half a palm, metres."""

CONTENT_MARGIN = 0.003
"""Smallest gap between two objects in one container, metres."""


@dataclass(frozen=True)
class LayoutResult:
    """A layout without collisions.

    Args:
        positions: (x, y, z) of every object's origin in the world, metres, by id in the order given.
        containers: id of the container that an object lies in or on, None on the table.
        displaced: distance from the target in the plane, metres, by id.
        cost_before, cost_after: the terms of the equation and J for what stands on the table.
        starts: L-BFGS-B starts of the table's problem; 0 when the targets were feasible already.
        feasible: how many of them became feasible.
        repaired: ids that the exact repair had to move.
        released: ids that a container had no room for after all; they stand on the table.
    """

    positions: dict[str, tuple[float, float, float]]
    containers: dict[str, str | None]
    displaced: dict[str, float]
    cost_before: Cost
    cost_after: Cost
    starts: int
    feasible: int
    repaired: list[str]
    released: list[str]


def optimize_layout(
    items: Sequence[LayoutItem],
    workspace: ArrayLike,
    rng: np.random.Generator,
    *,
    table_height: float,
    weights: Weights | None = None,
    margin: float = 0.01,
    restarts: int = 6,
) -> LayoutResult:
    """Move the objects as little as possible until none collides.

    Args:
        items: the objects with their targets.
        workspace: (2, 2) lower and upper corner that every box stays within, metres.
        rng: the only source of randomness.
        table_height: z of the table top.
        weights: the λ of the equation.
        margin: δ, smallest gap between objects that are not container and content.
        restarts: random starts besides the targets themselves.

    Raises:
        UsageError, UnknownName: see :func:`vcage.igsc.containers.validate_items`.
        InfeasibleScene: no collision-free layout was found; names the objects and the area that is missing.
    """
    validate_items(items)
    weights = weights or Weights()
    layout = _Layout(items, np.asarray(workspace, dtype=np.float64), rng, weights, margin, restarts)
    released = layout.fill_containers()
    roots = [item for item in items if layout.container[item.id] is None]
    problem = _table_problem(roots, layout.workspace, margin)
    solution = layout.solve(problem, roots)
    layout.stand(roots, solution, table_height)
    displaced = {item.id: float(np.hypot(*(np.array(layout.positions[item.id][:2]) - item.target))) for item in items}
    return LayoutResult(
        positions={item.id: layout.positions[item.id] for item in items},
        containers=layout.container,
        displaced=displaced,
        cost_before=evaluate(problem, weights, problem.target)[0],
        cost_after=evaluate(problem, weights, solution.centres)[0],
        starts=solution.starts,
        feasible=solution.feasible,
        repaired=sorted(layout.repaired),
        released=released,
    )


class _Layout:
    """The state of one optimisation: who lies where, and the local layout of every container."""

    def __init__(
        self,
        items: Sequence[LayoutItem],
        workspace: np.ndarray,
        rng: np.random.Generator,
        weights: Weights,
        margin: float,
        restarts: int,
    ):
        self.items, self.workspace, self.margin = items, workspace, margin
        self._rng, self._weights, self._restarts = rng, weights, restarts
        self.container = assign_containers(items)
        self.local: dict[str, np.ndarray] = {}  # id → (2,) centre in the container's frame
        self.positions: dict[str, tuple[float, float, float]] = {}
        self.repaired: set[str] = set()

    def solve(self, problem: LayoutProblem, items: Sequence[LayoutItem]) -> Solution:
        solution = solve(problem, [item.id for item in items], self._weights, self._rng, self._restarts)
        self.repaired |= {items[k].id for k in solution.repaired}
        return solution

    def contents(self, container: LayoutItem) -> list[LayoutItem]:
        return [item for item in self.items if self.container[item.id] == container.id]

    def fill_containers(self) -> list[str]:
        """Lay out the contents of every container; returns the ids of those that had to be released."""
        released = []
        for container in self.items:
            while contents := self.contents(container):
                try:
                    solution = self.solve(_container_problem(container, contents), contents)
                except InfeasibleScene as error:
                    smallest = min(contents, key=lambda item: (np.prod(item.size), item.id))
                    log.warning("%s goes beside %s: %s", smallest.id, container.id, error.message)
                    self.container[smallest.id] = None
                    released.append(smallest.id)
                    continue
                self.local |= {item.id: centre for item, centre in zip(contents, solution.centres, strict=True)}
                break
        return released

    def stand(self, roots: Sequence[LayoutItem], solution: Solution, height: float) -> None:
        """Positions in the world of the table's objects and, carried by them, of all contents."""
        for item, centre in zip(roots, solution.centres, strict=True):
            self._stand_one(item, centre, height)

    def _stand_one(self, item: LayoutItem, centre: np.ndarray, height: float) -> None:
        self.positions[item.id] = (float(centre[0]), float(centre[1]), float(height))
        for content in self.contents(item):
            inner = centre + _turn(item.yaw) @ self.local[content.id]
            self._stand_one(content, inner, height + item.opening.floor)


def _table_problem(items: Sequence[LayoutItem], workspace: np.ndarray, margin: float) -> LayoutProblem:
    return LayoutProblem(
        half=np.array([item.half_size() for item in items]),
        target=np.array([item.target for item in items], dtype=np.float64),
        bounds=workspace,
        margin=margin,
        allowed=tuple(None if item.allowed is None else np.reshape(item.allowed, (-1, 2, 2)) for item in items),
        extra=_hand_room(items, margin),
    )


def _hand_room(items: Sequence[LayoutItem], margin: float) -> np.ndarray:
    """(n, n) wider gaps between what is grasped and what is so high that the palm would touch it."""
    grasped = np.array([item.grasped for item in items])
    high = np.array([item.size[2] > PALM_ABOVE for item in items])
    pairs = grasped[:, None] & high[None]
    return np.where(pairs | pairs.T, max(PALM_ROOM - margin, 0.0), 0.0)


def _container_problem(container: LayoutItem, contents: Sequence[LayoutItem]) -> LayoutProblem:
    """The same problem in the container's own frame, so that its inner walls are axis-aligned at any heading."""
    offsets = np.array([item.target for item in contents]) - container.target
    centre, half = np.array(container.opening.centre), np.array(container.opening.size) / 2
    return LayoutProblem(
        half=np.array([item.half_size(container.yaw) for item in contents]),
        target=offsets @ _turn(container.yaw),
        bounds=np.stack([centre - half, centre + half]),
        margin=CONTENT_MARGIN,
        allowed=(None,) * len(contents),
    )


def _turn(yaw: float) -> np.ndarray:
    """(2, 2) rotation by ``yaw``; rows times it rotate by −yaw."""
    return np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])


def displacement_summary(displaced: Mapping[str, float]) -> dict[str, float]:
    """Mean, 95th percentile and largest displacement from the targets, metres."""
    values = np.array(list(displaced.values()))
    return {
        "mean_m": float(values.mean()),
        "p95_m": float(np.percentile(values, 95)),
        "max_m": float(values.max()),
    }
