"""The scenes of the placement benchmark: objects of the library with roles, and a workspace sized to them.

Scene (n, seed) is the same on every machine that has the same library; all methods get the same one.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace

import numpy as np

from vcage.base.geometry import Pose, footprint_half_size
from vcage.layout.items import Placement, TableItem, table_item
from vcage.layout.placement.reach import reach_for, robot_reach
from vcage.layout.placement.reach_map import SETTINGS as REACH
from vcage.objects.asset import Asset
from vcage.objects.library import Library
from vcage.scenes.starting_poses import MARGIN_M
from vcage.schema.scene import Role, Table
from vcage.sim.kinematics import ArmKinematics, kinematics_of
from vcage.sim.robots import load_robot

FILL = (0.2, 0.8)
"""Range of the fill ratio: sum of the objects' rectangles, each grown by the margin, over the workspace's area."""

ASPECT = 2.0
"""Width over depth of the workspace."""

MOST_CONTENTS, MOST_RECEPTACLES = 6, 2
"""A third of the objects are contents and a tenth receptacles, at least one of each, at most so many."""

ROBOT = "dual_panda"

REACHED_AREA = ((-1.0, -0.5), (1.0, 0.5))
"""Area in which reach is computed, metres; both arms' bases stand at its near edge, beyond it nothing is reached."""

EDGE = 0.2
"""Margin of the table beyond the workspace on every side, metres."""


@dataclass(frozen=True)
class Thing:
    """An object to be placed.

    Args:
        id: unique in its scene.
        room: the rectangle that it needs, and its headings.
        role: contents and receptacles are what a robot must reach, context is not.
    """

    id: str
    asset: Asset
    room: TableItem
    role: Role


@dataclass(frozen=True)
class BenchmarkScene:
    """The task of every method.

    Args:
        things: contents first, then receptacles, then context.
        workspace: (2, 2) lower and upper corner, metres.
    """

    things: list[Thing]
    workspace: np.ndarray
    height: float = field(default=Table().height)

    def items(self, reach: np.ndarray) -> list[TableItem]:
        """The items for our placement.

        Args:
            reach: (m, 2, 2) rectangles of the plane where an arm reaches; contents and receptacles must lie in one.
        """
        within = cut(reach, self.workspace)
        allowed = [reach_for(thing.asset, thing.role, within) for thing in self.things]
        return [replace(item, allowed=a) for item, a in zip(self.plain_items(), allowed, strict=True)]

    def plain_items(self) -> list[TableItem]:
        """The items for the other methods: they know no reach."""
        return [replace(t.room, id=t.id) for t in self.things]

    def poses(self, placed: dict[str, Placement]) -> dict[str, Pose]:
        """Pose in the world of every object that has a place."""
        return {t.id: t.room.pose(placed[t.id], self.height) for t in self.things if t.id in placed}

    @property
    def table(self) -> Table:
        """A table around the workspace."""
        size = self.workspace[1] - self.workspace[0] + 2 * EDGE
        return Table(size=(float(size[0]), float(size[1])), height=self.height)


class Stock:
    """The kinds that scenes are drawn from, and the robot that must reach into them; made once per process."""

    def __init__(self) -> None:
        self.library = Library.load()
        self._rooms: dict[tuple[str, str], TableItem] = {}

    def scene(self, n: int, seed: int) -> BenchmarkScene:
        """``n`` objects of different kinds, drawn uniformly; a kind's variants too."""
        rng = np.random.default_rng([n, seed])
        kinds = rng.choice(self.library.names, size=n, replace=n > len(self.library.names))
        assets = [self._variant(str(kind), rng) for kind in kinds]
        roles = draw_roles(assets)
        order = ("content", "receptacle", "context")
        chosen = sorted(range(n), key=lambda i: order.index(roles[i]))
        things = [Thing(f"{assets[i].name}-{i}", assets[i], self._room(assets[i]), roles[i]) for i in chosen]
        return BenchmarkScene(things, draw_workspace([t.room for t in things], rng))

    @functools.cached_property
    def kinematics(self) -> dict[str, ArmKinematics]:
        """Of the robot's arms."""
        return {name: kinematics_of(arm) for name, arm in load_robot(ROBOT).arms.items()}

    @functools.cached_property
    def reach(self) -> np.ndarray:
        """(m, 2, 2) rectangles where some arm reaches the object."""
        heights = tuple(Table().height + h for h in REACH.grasp_heights_m)
        return robot_reach(load_robot(ROBOT), REACHED_AREA, heights)

    def _variant(self, kind: str, rng: np.random.Generator) -> Asset:
        variants = self.library.annotation(kind).variants
        return self.library.asset(kind, variants[int(rng.integers(len(variants)))].id)

    def _room(self, asset: Asset) -> TableItem:
        key = (asset.name, asset.variant.id)
        if key not in self._rooms:
            self._rooms[key] = table_item(asset.name, asset)
        return self._rooms[key]


def draw_roles(assets: list[Asset]) -> list[Role]:
    """A role for each object: the first portable ones are contents, the next containers are receptacles.

    Objects with moving parts are context: what they need is reached at their front, not at their centre.
    """
    roles: list[Role] = ["context"] * len(assets)
    still = [i for i, asset in enumerate(assets) if not asset.articulated]
    carried = [i for i in still if assets[i].annotation.carrying_points]
    for i in carried[: min(MOST_CONTENTS, max(1, len(assets) // 3))]:
        roles[i] = "content"
    holding = [i for i in still if assets[i].annotation.functional_points and roles[i] == "context"]
    for i in holding[: min(MOST_RECEPTACLES, max(1, len(assets) // 10))]:
        roles[i] = "receptacle"
    return roles


def draw_workspace(rooms: list[TableItem], rng: np.random.Generator) -> np.ndarray:
    """(2, 2) a rectangle around the origin with a fill ratio drawn from :data:`FILL`, or less where one object alone
    needs more room (with the margin on all sides)."""
    area = sum(float(np.prod(np.add(room.size[:2], MARGIN_M))) for room in rooms)
    width = np.sqrt(ASPECT * area / rng.uniform(*FILL))
    for room in rooms:
        boxes = 2 * (footprint_half_size(room.size[:2], np.asarray(room.yaws)) + MARGIN_M)
        width = max(width, np.maximum(boxes[:, 0], ASPECT * boxes[:, 1]).min())
    half = np.array([width / 2, width / 2 / ASPECT])
    return np.stack([-half, half])


def cut(rectangles: np.ndarray, workspace: np.ndarray) -> np.ndarray:
    """(k, 2, 2) what of the rectangles (m, 2, 2) lies within the workspace (2, 2)."""
    lower = np.maximum(rectangles[:, 0], workspace[0])
    upper = np.minimum(rectangles[:, 1], workspace[1])
    return np.stack([lower, upper], axis=1)[np.all(lower < upper, axis=1)]
