"""Which objects lie in which container, and what a container has room for (paper, section III-A4).

An object is assigned to a container only where the plan permits it, its rectangle meets the container's or the plan
demands it, and the opening has room for it beside what is in there already. Overlap without permission is a collision.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vcage.base.errors import UsageError
from vcage.base.geometry import boxes_overlap, footprint_half_size
from vcage.layout.placement.place_item import as_rectangles, check_containers
from vcage.objects.openings import Opening
from vcage.plans.check import FILL_LIMIT

BARE = 0.002
"""A surface so little below its object's top is bare: what stands on it may stick out on all sides, metres."""

OVERHANG = 0.5
"""Share of a bare surface that the middle of what is wider must be over: the rest is its safety against tipping."""


@dataclass(frozen=True)
class LayoutItem:
    """An object of the layout.

    Args:
        id: its name in the result and in errors.
        size: (x, y, z) of the box that it needs at yaw 0, with the room that moving parts sweep, metres.
        yaw: its heading, radians; the optimiser does not turn objects.
        target: (x, y) where its origin should stand in the world.
        opening: what makes it a container, or None; its rim is infinitely high where things stand on it, not in it.
        inside: id of the container that it may lie in or on, by the plan; None to keep it clear of all.
        allowed: (m, 2, 2) rectangles that the middle of its own rectangle must lie in one of, None for anywhere; in a
            container they hold the container back.
        grasped: whether a hand will reach for it, and needs room beside it above what is low.
        centre: (x, y) of the rectangle's middle in the object's frame, metres
            (:class:`vcage.layout.placement.standing.Standing`).
        body: (2, 2) lower and upper corner of the object itself in its frame, by which relations are judged; the whole
            rectangle when left out.
    """

    id: str
    size: tuple[float, float, float]
    yaw: float
    target: tuple[float, float]
    opening: Opening | None = None
    inside: str | None = None
    allowed: ArrayLike | None = None
    grasped: bool = False
    centre: tuple[float, float] = (0.0, 0.0)
    body: ArrayLike | None = None

    def half_size(self, frame_yaw: float = 0.0) -> np.ndarray:
        """(2,) half size of its axis-aligned rectangle in a frame turned by ``frame_yaw``."""
        return footprint_half_size(self.size[:2], self.yaw - frame_yaw)

    def rectangle(self, frame_yaw: float = 0.0) -> np.ndarray:
        """(2, 2) its axis-aligned rectangle around its origin, in a frame turned by ``frame_yaw``."""
        return _rectangle(self.size[:2], self.centre, self.yaw - frame_yaw)

    def body_rectangle(self) -> np.ndarray:
        """(2, 2) the axis-aligned rectangle of the object itself around its origin, in the world's axes."""
        if self.body is None:
            return self.rectangle()
        lower, upper = np.asarray(self.body, dtype=np.float64)
        return _rectangle(upper - lower, (lower + upper) / 2, self.yaw)


def _rectangle(size: Sequence[float], middle: Sequence[float], yaw: float) -> np.ndarray:
    """(2, 2) the axis-aligned rectangle around one of that size and middle, turned about the origin."""
    c, s = math.cos(yaw), math.sin(yaw)  # numbers, as arrays of two are slow and this is asked often
    (w, d), (x, y) = size, middle
    half_x, half_y = (abs(c) * w + abs(s) * d) / 2, (abs(s) * w + abs(c) * d) / 2
    x, y = c * x - s * y, s * x + c * y
    return np.array([[x - half_x, y - half_y], [x + half_x, y + half_y]])


def validate_items(items: Sequence[LayoutItem]) -> None:
    """Refuse items that make no sense.

    Raises:
        UsageError: none at all, a number that is not finite, a size that is not positive, no rectangles.
        UsageError, UnknownName: see :func:`vcage.layout.placement.place_item.check_containers`.
    """
    if not items:
        raise UsageError("there is nothing to lay out", hint="run the stages before with --force")
    for item in items:
        _validate_item(item)
    check_containers(items)


def _validate_item(item: LayoutItem) -> None:
    body = () if item.body is None else np.ravel(item.body)
    if not np.all(np.isfinite([*item.size, item.yaw, *item.target, *item.centre, *body])):
        raise UsageError(
            f"{item.id} has no finite pose or size: size {item.size}, yaw {item.yaw}, target {item.target}",
            hint="run the stages before with --force",
        )
    if min(item.size) <= 0:
        raise UsageError(f"{item.id} has the size {item.size}", hint="sizes are positive metres; check its mesh")
    if item.allowed is not None:
        as_rectangles(item.allowed, f"where {item.id} may stand")


def assign_containers(items: Sequence[LayoutItem], demanded: Collection[str] = ()) -> dict[str, str | None]:
    """Container of each object by id, None for those on the table; the largest contents are assigned first.

    Args:
        items: the objects.
        demanded: ids that belong in or on their container wherever their targets are.
    """
    by_id = {item.id: item for item in items}
    assigned: dict[str, str | None] = {item.id: None for item in items}
    room = {item.id: _room(item.opening) for item in items if item.opening is not None}
    bare = {item.id for item in items if is_bare(item)}
    for item in sorted(items, key=lambda item: (-float(np.prod(item.size)), item.id)):
        if item.inside is None:
            continue
        container = by_id[item.inside]
        if item.id not in demanded and not boxes_overlap(_target_box(item), _target_box(container)):
            continue
        takes = np.array([4 * item.half_size(container.yaw).prod(), np.prod(item.size)])
        if container.id in bare:  # whatever comes first has room
            takes = np.minimum(takes, room[container.id])
        elif not (fits(item, container) and np.all(takes <= room[container.id])):
            continue
        assigned[item.id] = container.id
        room[container.id] = room[container.id] - takes
        # What sticks out leaves no room beside it.
        bare -= {container.id}
        if not fits(item, container):
            room[container.id] = np.zeros(2)
    return assigned


def is_bare(container: LayoutItem) -> bool:
    """Whether things stand on top of it, and nothing stands around them."""
    opening = container.opening
    return opening is not None and np.isinf(opening.rim) and opening.floor >= container.size[2] - BARE


def fits(item: LayoutItem, container: LayoutItem) -> bool:
    """Whether its rectangle, alone, is not larger than the opening."""
    return bool(np.all(2 * item.half_size(container.yaw) <= np.array(container.opening.size)))


def _room(opening: Opening) -> np.ndarray:
    """Floor area and volume that contents may take, m² and m³."""
    area = FILL_LIMIT * opening.size[0] * opening.size[1]
    return np.array([area, area * opening.depth])


def _target_box(item: LayoutItem) -> np.ndarray:
    return item.rectangle() + np.array(item.target)
