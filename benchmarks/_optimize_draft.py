"""Draft a scene of the optimisation benchmark: objects, containers, and positions inside them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from benchmarks._optimize_checks import PlacedAsset, colliding_meshes
from benchmarks._optimize_kinds import Kind
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose, footprint_half_size
from vcage.layout.items import Placement, TableItem
from vcage.layout.placement.place import place
from vcage.objects.openings import Opening

ASPECT = 2.0
"""Width of the workspace over its depth."""
CONTENT_GAP = 0.004
"""Smallest gap in a container of a clean layout, metres."""
ROOM = 0.6
"""Largest share of an opening that contents are drawn for; the optimiser refuses more than 0.9."""
NESTED = 0.3
"""Share of the containers after the first that are put in another one, if one has room."""


class Draft:
    """The objects, which of them lie in which, and the layout in every container."""

    def __init__(self, kinds: Sequence[Kind], n: int, containers: int, rng: np.random.Generator):
        self._rng, self._all = rng, kinds
        self._containers = [kind for kind in kinds if kind.opening is not None]
        # What has moving parts faces the robot, which in a turned container it would not.
        self._still = [kind for kind in kinds if not kind.asset.articulated]
        self.kinds: dict[str, Kind] = {}
        self.yaws: dict[str, float] = {}
        self.container: dict[str, str] = {}
        self.contents: dict[str, dict[str, Placement]] = {}  # container → content → place in the container's frame
        for _ in range(containers):
            self._add_container()
        while len(self.kinds) < n:
            into = rng.random() < 0.4 and containers > 0
            if not (into and self._add_content(str(rng.choice(list(self.contents))), tries=5)):
                self._name(self._draw(self._all))

    @property
    def roots(self) -> list[str]:
        """Ids of what stands on the table."""
        return [id for id in self.kinds if id not in self.container]

    def workspace(self, fill: float) -> np.ndarray:
        """(2, 2) the corners of a workspace, centred, of which the rooms on the table cover the share ``fill``."""
        area = sum(4 * self._half(id).prod() for id in self.roots)
        depth = np.sqrt(area / fill / ASPECT)
        return np.array([[-ASPECT, -1.0], [ASPECT, 1.0]]) * depth / 2

    def place_items(self, allowed: Mapping[str, np.ndarray]) -> list[TableItem]:
        """The objects on the table, to be placed; ``allowed`` as in :class:`TableItem`, by id."""
        return [
            replace(self.kinds[id].room, id=id, yaws=(self.yaws[id],), allowed=allowed.get(id)) for id in self.roots
        ]

    def poses(self, placed: Mapping[str, Placement]) -> dict[str, Pose]:
        """Poses of all objects from the places of the rooms of those on the table."""
        found = {id: self.kinds[id].room.pose(at, 0.0) for id, at in placed.items()}
        while len(found) < len(self.kinds):
            for id, container in self.container.items():
                if container in found:
                    at, floor = self.contents[container][id], self.kinds[container].interior.floor
                    found[id] = found[container] * Pose.from_yaw([at.x, at.y, floor], at.yaw)
        return {id: found[id] for id in self.kinds}

    def _half(self, id: str) -> np.ndarray:
        return footprint_half_size(self.kinds[id].room.size[:2], self.yaws[id])

    def _draw(self, kinds: Sequence[Kind]) -> Kind:
        return kinds[self._rng.integers(len(kinds))]

    def _name(self, kind: Kind) -> str:
        """Give a new object an id and a heading: one that it may have; square to the table half the time."""
        id = f"{kind.asset.name}_{len(self.kinds)}"
        square = self._rng.random() < 0.5
        yaw = self._rng.integers(4) * np.pi / 2 if square else self._rng.uniform(-np.pi, np.pi)
        self.kinds[id] = kind
        self.yaws[id] = float(self._rng.choice(kind.room.yaws) if kind.asset.articulated else yaw)
        return id

    def _add_container(self) -> None:
        """A container with one object in it, sometimes in another; kinds that nothing was found for are drawn again."""
        while True:
            nested = self.contents and self._rng.random() < NESTED
            id = (self._nest() if nested else None) or self._name(self._draw(self._containers))
            self.contents[id] = {}
            if self._add_content(id, tries=50):
                return
            self._forget(id)

    def _nest(self) -> str | None:
        """A container in one of the others, None when none goes in."""
        outer = str(self._rng.choice(list(self.contents)))
        return next((id for _ in range(50) if (id := self._put(self._draw(self._containers), outer))), None)

    def _forget(self, id: str) -> None:
        del self.kinds[id], self.yaws[id], self.contents[id]
        if outer := self.container.pop(id, None):
            del self.contents[outer][id]

    def _add_content(self, container: str, tries: int) -> bool:
        return any(self._put(self._draw(self._still), container) for _ in range(tries))

    def _put(self, kind: Kind, container: str) -> str | None:
        """Put an object of a kind into a container and lay that out again; None when it does not go in."""
        opening, inside = self.kinds[container].interior, [*self.contents[container]]
        id = self._name(kind)
        kinds = {other: self.kinds[other] for other in [*inside, id]}
        placed = self._lay_out(container, opening, kinds)
        if placed is None:
            del self.kinds[id], self.yaws[id]
            return None
        self.contents[container], self.container[id] = placed, container
        return id

    def _lay_out(self, container: str, opening: Opening, kinds: Mapping[str, Kind]) -> dict[str, Placement] | None:
        """Places in the container's frame with which the meshes are clear of each other and of the container."""
        outer = self.kinds[container]
        area = sum(4 * self._half(id).prod() for id in kinds)
        volume = sum(float(np.prod(kind.asset.size)) for kind in kinds.values())
        room = ROOM * opening.size[0] * opening.size[1]
        if area > room or volume > room * opening.depth:
            return None
        centre, half = np.array(opening.centre), np.array(opening.size) / 2
        items = [replace(kind.room, id=id, yaws=(self.yaws[id],)) for id, kind in kinds.items()]
        try:
            placed = place(items, np.stack([centre - half, centre + half]), self._rng, CONTENT_GAP)
        except InfeasibleScene:
            return None
        contents = {
            id: PlacedAsset(kind.asset, Pose.from_yaw([placed[id].x, placed[id].y, opening.floor], placed[id].yaw))
            for id, kind in kinds.items()
        }
        clear = not colliding_meshes({container: PlacedAsset(outer.asset, Pose()), **contents})
        return placed if clear else None
