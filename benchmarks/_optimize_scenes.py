"""Layouts that are known to be good, drawn from the library, and the noisy targets that are made of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks._optimize_checks import Standing
from benchmarks._optimize_draft import Draft
from benchmarks._optimize_kinds import Kind
from benchmarks._optimize_plan import plan_relations
from vcage.errors import InfeasibleScene
from vcage.geometry import Pose
from vcage.igsc.layout.containers import LayoutItem
from vcage.igsc.layout.cost import LayoutProblem
from vcage.igsc.layout.relation_cost import Spot, relation_terms
from vcage.igsc.placement.place import place
from vcage.schema.plan import Relation

MARGIN = 0.01
"""Smallest gap on the table, metres."""
CONTENT_MARGIN = 0.003
"""Smallest gap in a container, metres, as the optimiser asks for."""
FILL = (0.1, 0.6)
"""Least and largest share of the workspace that is covered by the boxes of what stands on the table."""
LOOSEN = 0.95
"""A workspace in which no clean layout was found is drawn again with so much of its fill ratio."""


@dataclass(frozen=True)
class CleanScene:
    """A layout without collisions, and the plan that it keeps.

    Args:
        kinds: by id, in the order in which they are given to the optimiser.
        poses: on a table of height 0, by id.
        containers: id of the container by id of the content; the others stand on the table.
        allowed: (m, 2, 2) rectangles that a centre must lie in, by id of those that are bound.
        workspace: (2, 2) metres.
        relations: the plan.
        fill: share of the workspace that the boxes of what stands on the table cover.
    """

    kinds: dict[str, Kind]
    poses: dict[str, Pose]
    containers: dict[str, str]
    allowed: dict[str, np.ndarray]
    workspace: np.ndarray
    relations: list[Relation]
    fill: float

    def targets(self, sigma: float, rng: np.random.Generator) -> dict[str, np.ndarray]:
        """(2,) targets by id: the clean places with independent normal noise along each axis, metres."""
        return {id: pose.p[:2] + rng.normal(0, sigma, 2) for id, pose in self.poses.items()}

    def items(self, targets: Mapping[str, np.ndarray]) -> list[LayoutItem]:
        """The optimiser's input."""
        return [
            kind.item(id, self.poses[id].yaw, targets[id], self.containers.get(id), self.allowed.get(id))
            for id, kind in self.kinds.items()
        ]

    def standing(
        self, positions: Mapping[str, Sequence[float]], containers: Mapping[str, str | None]
    ) -> dict[str, Standing]:
        """The objects at positions (x, y, z) in their own headings."""
        return {
            id: Standing(kind.asset, Pose.from_yaw(positions[id], self.poses[id].yaw), containers.get(id))
            for id, kind in self.kinds.items()
        }

    def problems(self, targets: Mapping[str, np.ndarray]) -> dict[str | None, tuple[list[str], LayoutProblem]]:
        """The ids and the equation's problem of every container, in its frame, and of the table (None)."""
        items = {item.id: item for item in self.items(targets)}
        inside: dict[str | None, list[LayoutItem]] = {}
        for item in items.values():
            inside.setdefault(item.inside, []).append(item)
        return {at: ([i.id for i in held], self._problem(held, items.get(at))) for at, held in inside.items()}

    def _problem(self, items: Sequence[LayoutItem], container: LayoutItem | None) -> LayoutProblem:
        target = np.array([item.target for item in items])
        if container is None:
            half, allowed = np.array([item.half_size() for item in items]), tuple(item.allowed for item in items)
            spots = {item.id: Spot(k, np.zeros(2), half[k]) for k, item in enumerate(items)}
            plan = relation_terms(self.relations, spots, len(items))
            return LayoutProblem(half, target, self.workspace, MARGIN, allowed, relations=plan)
        turn = Pose.from_yaw([0, 0, 0], container.yaw).rotation()[:2, :2]
        centre, room = np.array(container.opening.centre), np.array(container.opening.size) / 2
        return LayoutProblem(
            half=np.array([item.half_size(container.yaw) for item in items]),
            target=(target - container.target) @ turn,
            bounds=np.stack([centre - room, centre + room]),
            margin=CONTENT_MARGIN,
            allowed=(None,) * len(items),
        )


def draw_scene(kinds: Sequence[Kind], n: int, containers: int, bound: bool, rng: np.random.Generator) -> CleanScene:
    """A scene of ``n`` objects, ``containers`` of which hold at least one of the others.

    Args:
        kinds: what to draw from.
        n: objects in all; at least twice ``containers``.
        containers: how many hold something.
        bound: whether an arm's reach binds the containers, the contents and half of the others.
        rng: the only source of randomness.
    """
    draft = Draft(kinds, n, containers, rng)
    fill = rng.uniform(*FILL)
    allowed: dict[str, np.ndarray] = {}
    bound_ids = [id for id in draft.roots if id in draft.contents or rng.random() < 0.5] if bound else []
    while True:
        workspace = draft.workspace(fill)
        allowed = dict.fromkeys(bound_ids, _reach(workspace))
        try:
            placed = place(draft.place_items(allowed), workspace, rng, MARGIN)
            break
        except InfeasibleScene:
            fill *= LOOSEN
    poses = draft.poses(placed)
    if bound:
        inner = {id: _reach(workspace) for id in draft.container if is_within(poses[id].p[:2], _reach(workspace))}
        allowed = {**allowed, **inner}
    scene = CleanScene(draft.kinds, poses, draft.container, allowed, workspace, [], fill)
    boxes = {id: s.box for id, s in scene.standing({id: p.p for id, p in poses.items()}, draft.container).items()}
    supports = {id: (draft.kinds[c].word, c) for id, c in draft.container.items()}
    return replace(scene, relations=plan_relations(boxes, supports, rng))


def _reach(workspace: np.ndarray) -> np.ndarray:
    """(2, 2, 2) where two arms at the near edge reach, roughly: all but the far corners, as two rectangles."""
    lower, upper = workspace
    width, depth = upper - lower
    return np.array(
        [
            [lower, [upper[0], lower[1] + 0.75 * depth]],
            [[lower[0] + 0.15 * width, lower[1]], [upper[0] - 0.15 * width, upper[1]]],
        ]
    )


def is_within(point: np.ndarray, rectangles: np.ndarray, tolerance: float = 0.0) -> bool:
    """Whether a point (2,) lies in one of the rectangles (m, 2, 2), or within ``tolerance`` metres of one."""
    lower, upper = rectangles[:, 0] - tolerance, rectangles[:, 1] + tolerance
    return bool(((lower <= point) & (point <= upper)).all(axis=1).any())
