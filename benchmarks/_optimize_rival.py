"""A plain rival: L-BFGS-B on the same cost from the targets, with scipy's own finite differences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from benchmarks._optimize_scenes import CleanScene
from vcage.base.geometry import Pose
from vcage.layout.cost import CostWeights, LayoutProblem
from vcage.layout.items import TableItem
from vcage.layout.placement.contents import CONTENT_MARGIN_M
from vcage.layout.placement.free_region import nearest_in_rectangles
from vcage.layout.relation_cost import RelatedBox, RelationTerms, relation_terms


@dataclass(frozen=True)
class Part:
    """The equation's problem of what stands on one support.

    Args:
        ids: of its objects, in the problem's order.
        middles: (n, 2) way from the origin of each to the middle of its rectangle, which the problem moves, metres.
    """

    ids: list[str]
    middles: np.ndarray
    problem: LayoutProblem


def parts(clean: CleanScene, targets: Mapping[str, np.ndarray]) -> dict[str | None, Part]:
    """Split a scene into problems: each container in its frame, and the table (None). The rival knows the contents."""
    items = {item.id: item for item in clean.items(targets)}
    inside: dict[str | None, list[TableItem]] = {}
    for item in items.values():
        inside.setdefault(item.inside, []).append(item)
    return {
        at: _on_the_table(held, clean) if at is None else _in_container(held, items[at]) for at, held in inside.items()
    }


def _on_the_table(items: Sequence[TableItem], clean: CleanScene) -> Part:
    middles, half = _rectangles(items, 0.0)
    problem = LayoutProblem(
        half=half,
        target=np.array([item.target for item in items]) + middles,
        bounds=clean.workspace,
        margin=clean.setting.margin,
        allowed=tuple(None if item.allowed is None else np.asarray(item.allowed) for item in items),
        relations=_plan(items, middles, clean),
    )
    return Part([item.id for item in items], middles, problem)


def _in_container(items: Sequence[TableItem], container: TableItem) -> Part:
    middles, half = _rectangles(items, container.yaw)
    turn = Pose.from_yaw([0, 0, 0], container.yaw).rotation()[:2, :2]
    centre, room = np.array(container.room.centre), np.array(container.room.size) / 2
    problem = LayoutProblem(
        half=half,
        target=(np.array([item.target for item in items]) - container.target) @ turn + middles,
        bounds=np.stack([centre - room, centre + room]),
        margin=CONTENT_MARGIN_M,
        allowed=(None,) * len(items),
    )
    return Part([item.id for item in items], middles, problem)


def _rectangles(items: Sequence[TableItem], frame_yaw: float) -> tuple[np.ndarray, np.ndarray]:
    """(n, 2) middles around the origins, and half sizes, in a frame turned by a yaw."""
    corners = np.array([item.rectangle(frame_yaw) for item in items])
    return corners.mean(axis=1), (corners[:, 1] - corners[:, 0]) / 2


def _plan(items: Sequence[TableItem], middles: np.ndarray, clean: CleanScene) -> RelationTerms | None:
    """The plan's term; relations are judged by the objects themselves, not by what they sweep."""
    spots = {}
    for k, (item, middle) in enumerate(zip(items, middles, strict=True)):
        lower, upper = item.body_rectangle()
        spots[item.id] = RelatedBox(k, (lower + upper) / 2 - middle, (upper - lower) / 2)
    return relation_terms(clean.relations, spots, len(items))


def finite_differences(problem: LayoutProblem, weights: CostWeights) -> np.ndarray:
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
    """J of :mod:`vcage.layout.cost` without its gradient, so that the rival pays for no unused work.

    Every pair has the same margin. Only the plan's term makes its gradient too: it is small beside the pairs.
    """

    def __init__(self, problem: LayoutProblem, weights: CostWeights):
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
