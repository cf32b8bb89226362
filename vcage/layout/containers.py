"""Assignment of objects to containers that have room for them (paper, section III-A4).

An object is assigned to a container only where the plan permits it, its rectangle meets the container's or the plan
demands it, and the opening has room for it beside what is in there already. Overlap without permission is a collision.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from vcage.base.geometry import boxes_overlap
from vcage.layout.items import ITEMS, TableItem
from vcage.objects.openings import Opening


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
    pairs = [(item, by_id[item.inside]) for item in items if item.inside is not None and not item.fixed]
    for item, container in sorted(pairs, key=lambda pair: (-float(np.prod(pair[0].size)), pair[0].id)):
        if not (item.id in demanded or boxes_overlap(_target_box(item), _target_box(container))):
            continue
        takes = _takes(item, container, room[container.id], container.id in bare)
        if takes is not None:
            assigned[item.id] = container.id
            # What sticks out leaves no room beside it.
            room[container.id] = room[container.id] - takes if fits_opening(item, container) else np.zeros(2)
            bare -= {container.id}
    return assigned


def _takes(item: TableItem, container: TableItem, room: np.ndarray, bare: bool) -> np.ndarray | None:
    """(2,) floor area and volume that it takes of what is left, m² and m³; None where there is no room for it.

    On a surface that is still bare, whatever comes first has room.
    """
    takes = np.array([4 * item.half_size(container.yaw).prod(), np.prod(item.size)])
    if bare:
        return np.minimum(takes, room)
    return takes if fits_opening(item, container) and np.all(takes <= room) else None


def fits_opening(item: TableItem, container: TableItem) -> bool:
    """True if its rectangle, alone, is not larger than the opening."""
    return bool(np.all(2 * item.half_size(container.yaw) <= np.array(container.room.size)))


def _room(opening: Opening) -> np.ndarray:
    """Floor area and volume that contents may take, m² and m³."""
    area = ITEMS.fill_share * opening.size[0] * opening.size[1]
    return np.array([area, area * opening.depth])


def _target_box(item: TableItem) -> np.ndarray:
    return item.rectangle() + np.array(item.target)
