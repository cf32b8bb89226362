"""Collision-free placement optimisation with containers as groups (paper, section III-A4).

Contents are optimised together in the frame of their container, innermost containers first; then every container
is moved as a rigid body with its contents. Support heights follow: table top, container floor.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from vcage.base.errors import InfeasibleScene, UnknownName, UsageError
from vcage.layout.check import require_exact
from vcage.layout.cost import Cost, CostWeights, evaluate
from vcage.layout.groups import Groups
from vcage.layout.items import TableItem
from vcage.layout.solver import Solution, solve
from vcage.layout.validation import as_workspace, check_items, check_margin
from vcage.schema.plan import TABLE, Relation
from vcage.schema.scene import Table

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class LayoutOptions:
    """Demands on a layout, and the effort of the search.

    Args:
        weights: the λ of the equation; ``relation=0`` leaves the plan out, except for contents.
        margin: δ, smallest gap between objects that are not container and content, metres.
        restarts: most random starts besides the targets themselves; more search longer where it is hard.

    Raises:
        UsageError: the margin is negative or not finite, or the restarts are negative.
    """

    weights: CostWeights = field(default_factory=CostWeights)
    margin: float = 0.01
    restarts: int = 6

    def __post_init__(self) -> None:
        check_margin(self.margin)
        if self.restarts < 0:
            raise UsageError(f"{self.restarts} restarts", hint="0 or more")


@dataclass(frozen=True)
class LayoutResult:
    """A layout without collisions.

    Args:
        positions: (x, y, z) of every object's origin in the world, metres, by id in the order given.
        containers: id of the container that an object lies in or on, None on the table.
        displaced: distance from the target in the plane, metres, by id.
        cost_before, cost_after: the terms of the equation and J for the objects on the table.
        starts: L-BFGS-B descents of the table's problem; 0 when the targets were feasible already.
        repaired: ids that the exact repair had to move.
        released: ids that a container had no room for after all; they stand on the table.
        out_of_reach: ids of contents that are not where they are allowed, as their container cannot stand so.
        hand_room: share of the room for hands, wider than the margin, that the table had space for; 1 is all.
    """

    positions: dict[str, tuple[float, float, float]]
    containers: dict[str, str | None]
    displaced: dict[str, float]
    cost_before: Cost
    cost_after: Cost
    starts: int
    repaired: list[str]
    released: list[str]
    out_of_reach: list[str]
    hand_room: float = 1.0

    def without(self, names: Collection[str]) -> LayoutResult:
        """Return the result without some objects.

        Args:
            names: their ids.
        """
        fields = vars(self).items()
        lists = {name: [one for one in of if one not in names] for name, of in fields if isinstance(of, list)}
        by_id = {
            name: {one: value for one, value in of.items() if one not in names}
            for name, of in fields
            if isinstance(of, dict)
        }
        return replace(self, **lists, **by_id)


def optimize_layout(
    items: Sequence[TableItem],
    workspace: ArrayLike,
    table: Table,
    rng: np.random.Generator,
    relations: Sequence[Relation] = (),
    options: LayoutOptions | None = None,
) -> LayoutResult:
    """Move the objects as little as possible until none collides and the plan is kept.

    Of the collision-free layouts found, the one with the most satisfied relations is returned, and among
    those the one that moves least. Relations that contradict each other cost each other, never a collision.

    Args:
        items: the objects with their targets.
        workspace: (2, 2) lower and upper corner, the bounds of every box, metres.
        table: the table below them.
        rng: the only source of randomness.
        relations: of the plan, by object id.
        options: the default ones when left out.

    Raises:
        UsageError, UnknownName: see :func:`vcage.layout.validation.check_items`; a relation names no object.
        InfeasibleScene: no collision-free layout was found; names the objects and the area that is missing.
    """
    options = options or LayoutOptions()
    if not items:
        raise UsageError("there is nothing to lay out", hint="make the stages before again")
    check_items(items)
    bounds = as_workspace(workspace)
    _require_known(relations, items)
    groups = Groups(items, relations)
    search = partial(solve, weights=options.weights, rng=rng, restarts=options.restarts)
    repaired, released = _fill_containers(groups, search)
    allowed, out_of_reach = groups.allowed()
    for name in out_of_reach:
        logger.warning("%s cannot be reached where %s may stand", name, groups.root(groups.items[name]).id)
    problem = groups.table_problem(bounds, options.margin, allowed)
    solution = search(problem, [item.id for item in groups.roots])
    if solution.extra < 1:
        logger.warning("the table has space for %.0f %% of the room for hands", 100 * solution.extra)
    origins = solution.centres - problem.target + np.array([item.target for item in groups.roots])
    positions = groups.positions(groups.roots, origins, table.height)
    require_exact(groups, positions, bounds, options.margin, out_of_reach)
    displaced = {
        name: float(np.hypot(*np.subtract(positions[name][:2], item.target))) for name, item in groups.items.items()
    }
    return LayoutResult(
        positions=positions,
        containers=groups.container,
        displaced=displaced,
        cost_before=evaluate(problem, options.weights, problem.target)[0],
        cost_after=evaluate(problem, options.weights, solution.centres)[0],
        starts=solution.starts,
        repaired=sorted(repaired.union(solution.repaired)),
        released=released,
        out_of_reach=out_of_reach,
        hand_room=solution.extra,
    )


def _fill_containers(groups: Groups, search: Callable[..., Solution]) -> tuple[set[str], list[str]]:
    """Lay out the contents of every container; return the ids that the repair moved, and those that were released."""
    repaired: set[str] = set()
    released = []
    for container in groups.innermost_first():
        while contents := groups.contents(container):
            try:
                solution = search(groups.container_problem(container), [item.id for item in contents])
            except InfeasibleScene as error:
                smallest = min(contents, key=lambda item: (np.prod(item.size), item.id))
                logger.warning("%s goes beside %s: %s", smallest.id, container.id, error.message)
                groups.release(smallest, container)
                released.append(smallest.id)
                continue
            groups.settle(container, solution.centres)
            repaired.update(solution.repaired)
            break
    return repaired, released


def _require_known(relations: Sequence[Relation], items: Sequence[TableItem]) -> None:
    known = {TABLE, *(item.id for item in items)}
    for name in (name for r in relations for name in (r.subject, r.reference)):
        if name not in known:
            raise UnknownName("object", name, known)


def displacement_summary(displaced: Mapping[str, float]) -> dict[str, float]:
    """Mean, 95th percentile and largest displacement from the targets, metres."""
    values = np.array(list(displaced.values()))
    return {
        "mean_m": float(values.mean()),
        "p95_m": float(np.percentile(values, 95)),
        "max_m": float(values.max()),
    }
