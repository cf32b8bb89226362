"""Objects that lie in containers from the start.

Contents of a container are placed first, in the container's own frame, where the opening is an axis-aligned plane at
any heading. The container is then placed as a rigid body, so contents take no room of the table; where they must be
reached or seen limits where the container may stand.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vcage.base.geometry import footprint_half_size, rotation_2d, wrap_angle
from vcage.layout.items import Placement, TableItem, centres_within
from vcage.layout.placement.plane import Plane, make_plane
from vcage.layout.validation import as_rectangles

CONTENT_MARGIN_M = 0.003
"""Smallest gap between two objects in one container, and to its walls, metres."""


@dataclass(frozen=True)
class Local:
    """Place of a content: (2,) centre, metres, and yaw, radians, in the frame of its container's footprint."""

    centre: np.ndarray
    yaw: float


def contents_of(items: Sequence[TableItem], container: str | None) -> list[TableItem]:
    """Items directly in a container, or on the table."""
    return [item for item in items if item.inside == container]


def content_plane(container: TableItem, contents: Sequence[TableItem]) -> Plane:
    """The opening of a container, in the frame of its footprint."""
    opening = container.room
    centre, half = np.subtract(opening.centre, container.centre), np.array(opening.size) / 2 - CONTENT_MARGIN_M
    # Reach and view are the world's: they are asked of the container, see unions_of.
    plain = [replace(item, allowed=None, within=None) for item in contents]
    bounds = np.stack([centre - half, centre + half])
    plane = make_plane(plain, bounds, CONTENT_MARGIN_M, np.empty((0, 2, 2)), lambda _item, _yaw: ())
    return replace(plane, container=container.id)


class Carried:
    """Limits of a container's place by its contents.

    Args:
        items: all objects.
        local: where every content lies, by id.
    """

    def __init__(self, items: Sequence[TableItem], local: Mapping[str, Local]):
        self._items, self._local = items, local
        self._containers = {item.inside for item in items}
        self._allowed = {
            item.id: as_rectangles(item.allowed, f"where {item.id} may stand")
            for item in items
            if item.allowed is not None
        }
        self._within = {
            item.id: as_rectangles(item.within, f"where {item.id} is seen") for item in items if item.within is not None
        }

    def unions(self, item: TableItem, yaw: float) -> list[np.ndarray]:
        """Unions of rectangles (m, 2, 2); the item's centre at ``yaw`` must lie in one rectangle of each."""
        found = [self._allowed[item.id]] if item.id in self._allowed else []
        if item.id not in self._containers:
            return found
        for content, at in self.below(item, yaw):
            if content.id in self._allowed:
                found.append(self._allowed[content.id] - at.centre)
            if content.id in self._within:
                half = footprint_half_size(content.size[:2], at.yaw)
                found.append(centres_within(self._within[content.id] - at.centre, half))
        return found

    def stand(self, item: TableItem, at: Placement) -> dict[str, Placement]:
        """Places in the world of an item at ``at`` and of all that it carries."""
        found = {item.id: at}
        for content in contents_of(self._items, item.id):
            local = self._local[content.id]
            x, y = np.array([at.x, at.y]) + rotation_2d(at.yaw) @ local.centre
            yaw = float(wrap_angle(at.yaw + local.yaw))
            found |= self.stand(content, Placement(float(x), float(y), yaw, at.z + item.room.floor))
        return found

    def below(self, item: TableItem, yaw: float) -> list[tuple[TableItem, Local]]:
        """All that an item at a yaw carries, with (2,) offset from the item's centre and heading, along world axes."""
        found: list[tuple[TableItem, Local]] = []
        for content in contents_of(self._items, item.id):
            local = self._local[content.id]
            way, turned = rotation_2d(yaw) @ local.centre, yaw + local.yaw
            inner = [(deeper, Local(way + at.centre, at.yaw)) for deeper, at in self.below(content, turned)]
            found += [(content, Local(way, turned)), *inner]
        return found
