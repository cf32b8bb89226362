"""Which objects lie in which container, and what a container has room for (paper, section III-A4).

An object is assigned to a container only where the plan permits it, its box meets the container's box, and the
opening has room for it beside what is in there already. Overlap without permission is a collision.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vcage.assets.openings import Opening
from vcage.errors import UnknownName, UsageError
from vcage.geometry import boxes_overlap, footprint_half_size

FILL_LIMIT = 0.9
"""Largest share of an opening's floor and volume that contents may take."""


@dataclass(frozen=True)
class LayoutItem:
    """An object of the layout.

    Args:
        id: its name in the result and in errors.
        size: (x, y, z) of its bounding box at yaw 0, metres.
        yaw: its heading, radians; the optimiser does not turn objects.
        target: (x, y) where it should stand in the world.
        opening: what makes it a container, or None; its rim is infinitely high where things stand on it, not in it.
        inside: id of the container that it may lie in or on, by the plan; None to keep it clear of all.
        allowed: (m, 2, 2) rectangles that its centre must lie in one of, None for anywhere; not used in a container.
        grasped: whether a hand will reach for it, and needs room beside it above what is low.
    """

    id: str
    size: tuple[float, float, float]
    yaw: float
    target: tuple[float, float]
    opening: Opening | None = None
    inside: str | None = None
    allowed: ArrayLike | None = None
    grasped: bool = False

    def half_size(self, frame_yaw: float = 0.0) -> np.ndarray:
        """(2,) half size of its axis-aligned rectangle in a frame turned by ``frame_yaw``."""
        return footprint_half_size(self.size[:2], self.yaw - frame_yaw)


def validate_items(items: Sequence[LayoutItem]) -> None:
    """Refuse items that make no sense.

    Raises:
        UsageError: an id twice, a number that is not finite, a size that is not positive, a container inside itself.
        UnknownName: ``inside`` names nothing that has an opening.
    """
    ids = [item.id for item in items]
    containers = {item.id: item for item in items if item.opening is not None}
    for item in items:
        if ids.count(item.id) > 1:
            raise UsageError(f"two objects are called {item.id!r}", hint="give every object an id of its own")
        if not np.all(np.isfinite([*item.size, item.yaw, *item.target])):
            raise UsageError(
                f"{item.id} has no finite pose or size: size {item.size}, yaw {item.yaw}, target {item.target}",
                hint="run the stages before with --force",
            )
        if min(item.size) <= 0:
            raise UsageError(f"{item.id} has the size {item.size}", hint="sizes are positive metres; check its mesh")
        if item.inside is not None and item.inside not in containers:
            raise UnknownName("container", item.inside, containers)
    inside = {item.id: item.inside for item in items}
    for item in items:
        _require_no_circle(item.id, inside)


def _require_no_circle(start: str, inside: Mapping[str, str | None]) -> None:
    seen, at = [start], inside[start]
    while at is not None:
        if at in seen:
            raise UsageError(
                f"containers in a circle: {' in '.join([*seen, at])}",
                hint="a container cannot lie inside itself; mend the plan",
            )
        seen.append(at)
        at = inside[at]


def assign_containers(items: Sequence[LayoutItem]) -> dict[str, str | None]:
    """Container of each object by id, None for those on the table; the largest contents are assigned first."""
    by_id = {item.id: item for item in items}
    assigned: dict[str, str | None] = {item.id: None for item in items}
    room = {item.id: _room(item.opening) for item in items if item.opening is not None}
    for item in sorted(items, key=lambda item: (-float(np.prod(item.size)), item.id)):
        if item.inside is None:
            continue
        container = by_id[item.inside]
        takes = np.array([4 * item.half_size(container.yaw).prod(), np.prod(item.size)])
        meets = boxes_overlap(_target_box(item), _target_box(container))
        if meets and _passes(item, container) and np.all(takes <= room[container.id]):
            assigned[item.id] = container.id
            room[container.id] = room[container.id] - takes
    return assigned


def _room(opening: Opening) -> np.ndarray:
    """Floor area and volume that contents may take, m² and m³."""
    area = FILL_LIMIT * opening.size[0] * opening.size[1]
    return np.array([area, area * opening.depth])


def _passes(item: LayoutItem, container: LayoutItem) -> bool:
    return bool(np.all(2 * item.half_size(container.yaw) <= np.array(container.opening.size)))


def _target_box(item: LayoutItem) -> np.ndarray:
    half, target = item.half_size(), np.array(item.target)
    return np.stack([target - half, target + half])
