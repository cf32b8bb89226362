"""Layouts that are known to be good, drawn from the library, and the noisy targets that are made of them."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from benchmarks._optimize_checks import PlacedAsset
from benchmarks._optimize_draft import Draft
from benchmarks._optimize_kinds import Kind
from benchmarks._optimize_plan import plan_relations
from benchmarks._placement_scenes import ROBOT, draw_roles
from benchmarks._shapes import ROUNDING
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.layout.items import HandClearance, TableItem, hand_clearance
from vcage.layout.placement.place import place
from vcage.schema.plan import Relation
from vcage.sim.robots import load_robot
from vcage.stages.optimize import Options


@functools.cache
def _hand() -> HandClearance:
    return hand_clearance(load_robot(ROBOT))


@dataclass(frozen=True)
class Setting:
    """Conditions for the optimiser beside the targets and the plan.

    Args:
        name: in the table.
        margin: smallest gap on the table, metres; clean layouts keep it too.
        hands: True if portable objects are grasped and need room for a hand beside high ones.
    """

    name: str
    margin: float
    hands: bool


PLAIN = Setting("plain", 0.01, hands=False)
"""Boxes a centimetre apart, as others measure."""
STAGE = Setting("stage", Options().margin, hands=True)
"""The conditions of the pipeline's own stage: its margin, and hand room around its contents."""
FILL = (0.1, 0.6)
"""Least and largest share of the workspace that is covered by the rooms of what stands on the table."""
LOOSEN = 0.95
"""A workspace in which no clean layout was found is drawn again with so much of its fill ratio."""


@dataclass(frozen=True)
class CleanScene:
    """A layout without collisions, and the plan that it keeps.

    Args:
        kinds: by id, in the order in which they are given to the optimiser.
        poses: on a table of height 0, by id.
        containers: id of the container by id of the content; the others stand on the table.
        allowed: (m, 2, 2) rectangles for the middle of a room, by id of the bound objects.
        workspace: (2, 2) metres.
        relations: the plan.
        fill: share of the workspace covered by the rooms of the objects on the table.
        setting: the request to the optimiser.
        grasped: ids of what a hand will reach for.
    """

    kinds: dict[str, Kind]
    poses: dict[str, Pose]
    containers: dict[str, str]
    allowed: dict[str, np.ndarray]
    workspace: np.ndarray
    relations: list[Relation]
    fill: float
    setting: Setting = PLAIN
    grasped: frozenset[str] = frozenset()

    def targets(self, sigma: float, rng: np.random.Generator) -> dict[str, np.ndarray]:
        """(2,) targets by id: the clean places with independent normal noise along each axis, metres."""
        return {id: pose.p[:2] + rng.normal(0, sigma, 2) for id, pose in self.poses.items()}

    def items(self, targets: Mapping[str, np.ndarray]) -> list[TableItem]:
        """The optimiser's input."""
        hands = dict.fromkeys(self.grasped, _hand())
        return [
            kind.item(id, self.poses[id].yaw, targets[id], self.containers.get(id), self.allowed.get(id), hands.get(id))
            for id, kind in self.kinds.items()
        ]

    def placed(
        self, positions: Mapping[str, ArrayLike], containers: Mapping[str, str | None]
    ) -> dict[str, PlacedAsset]:
        """The objects at positions (x, y, z) of their origins, in their own headings."""
        return {
            id: PlacedAsset(
                kind.asset, Pose.from_yaw(positions[id], self.poses[id].yaw), containers.get(id), kind.rectangle
            )
            for id, kind in self.kinds.items()
        }

    def in_bounds(self, thing: PlacedAsset) -> bool:
        """True if the whole area of an object is in the workspace."""
        room, (lower, upper) = thing.room_in(Pose())[:, :2], self.workspace
        return bool(np.all(room[0] >= lower - ROUNDING) and np.all(room[1] <= upper + ROUNDING))

    def in_reach(self, placed: Mapping[str, PlacedAsset]) -> bool:
        """True if every bound object on the table is where it may be."""
        bound = {id: thing for id, thing in placed.items() if thing.container is None and id in self.allowed}
        return all(is_within(_middle(thing), self.allowed[id], ROUNDING) for id, thing in bound.items())


def _middle(thing: PlacedAsset) -> np.ndarray:
    """(2,) middle of the object's room in the world."""
    room = thing.asset.bounds[:, :2] if thing.room is None else thing.room
    return thing.pose.apply(np.array([*room.mean(axis=0), 0.0]))[:2]


def draw_scene(
    kinds: Sequence[Kind], n: int, containers: int, bound: bool, rng: np.random.Generator, setting: Setting = PLAIN
) -> CleanScene:
    """A scene of ``n`` objects, ``containers`` of which hold at least one of the others.

    Args:
        kinds: what to draw from.
        n: objects in all; at least twice ``containers``.
        containers: number of objects with contents.
        bound: True if an arm's reach binds the containers, the contents and half of the other rigid objects.
        rng: the only source of randomness.
        setting: the request to the optimiser.
    """
    draft = Draft(kinds, n, containers, rng)
    fill = rng.uniform(*FILL)
    still = [id for id in draft.roots if not draft.kinds[id].asset.articulated]
    bound_ids = [id for id in still if id in draft.contents or rng.random() < 0.5] if bound else []
    while True:
        workspace = draft.workspace(fill)
        allowed = dict.fromkeys(bound_ids, _reach(workspace))
        try:
            placed = place(draft.place_items(allowed), workspace, rng, setting.margin)
            break
        except InfeasibleScene:
            fill *= LOOSEN
    poses = draft.poses(placed)
    if bound:
        inner = {id: _reach(workspace) for id in draft.container if is_within(poses[id].p[:2], _reach(workspace))}
        allowed = {**allowed, **inner}
    grasped = _grasped(draft.kinds) if setting.hands else frozenset()
    scene = CleanScene(draft.kinds, poses, draft.container, allowed, workspace, [], fill, setting, grasped)
    boxes = {id: s.box for id, s in scene.placed({id: p.p for id, p in poses.items()}, draft.container).items()}
    supports = {id: (draft.kinds[c].word, c) for id, c in draft.container.items()}
    return replace(scene, relations=plan_relations(boxes, supports, rng))


def _grasped(kinds: Mapping[str, Kind]) -> frozenset[str]:
    """Ids of a task's contents, by the same rule as in the placement benchmark."""
    roles = draw_roles([kind.asset for kind in kinds.values()])
    return frozenset(id for id, role in zip(kinds, roles, strict=True) if role == "content")


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
    """True if a point (2,) lies in one of the rectangles (m, 2, 2), or within ``tolerance`` metres of one."""
    lower, upper = rectangles[:, 0] - tolerance, rectangles[:, 1] + tolerance
    return bool(((lower <= point) & (point <= upper)).all(axis=1).any())
