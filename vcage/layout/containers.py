"""Which objects lie in which container, and what a container has room for (paper, section III-A4).

An object is assigned to a container only where the plan permits it, its rectangle meets the container's or the plan
demands it, and the opening has room for it beside what is in there already. Overlap without permission is a collision.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from vcage.base.errors import UsageError
from vcage.base.geometry import boxes_overlap
from vcage.layout.items import FILL_LIMIT, TableItem, as_rectangles, check_containers
from vcage.objects.openings import Opening

OVERHANG = 0.5
"""Share of a bare surface that the middle of what is wider must be over: the rest is its safety against tipping."""


def validate_items(items: Sequence[TableItem]) -> None:
    """Refuse items that make no sense.

    Raises:
        UsageError: none at all, a number that is not finite, a size that is not positive, no rectangles.
        UsageError, UnknownName: see :func:`vcage.layout.items.check_containers`.
    """
    if not items:
        raise UsageError("there is nothing to lay out", hint="run the stages before with --force")
    for item in items:
        _validate_item(item)
    check_containers(items)


def _validate_item(item: TableItem) -> None:
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


def assign_containers(items: Sequence[TableItem], demanded: Collection[str] = ()) -> dict[str, str | None]:
    """Container of each object by id, None for those on the table; the largest contents are assigned first.

    Args:
        items: the objects.
        demanded: ids that belong in or on their container wherever their targets are.
    """
    by_id = {item.id: item for item in items}
    assigned: dict[str, str | None] = {item.id: None for item in items}
    room = {item.id: _room(item.opening) for item in items if item.opening is not None}
    bare = {item.id for item in items if item.bare}
    movable = [item for item in items if item.inside is not None and not item.fixed]
    for item in sorted(movable, key=lambda item: (-float(np.prod(item.size)), item.id)):
        container = by_id[str(item.inside)]
        if not (item.id in demanded or boxes_overlap(_target_box(item), _target_box(container))):
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


def fits(item: TableItem, container: TableItem) -> bool:
    """Whether its rectangle, alone, is not larger than the opening."""
    return bool(np.all(2 * item.half_size(container.yaw) <= np.array(container.room.size)))


def _room(opening: Opening) -> np.ndarray:
    """Floor area and volume that contents may take, m² and m³."""
    area = FILL_LIMIT * opening.size[0] * opening.size[1]
    return np.array([area, area * opening.depth])


def _target_box(item: TableItem) -> np.ndarray:
    return item.rectangle() + np.array(item.target)
