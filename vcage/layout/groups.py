"""Groups of objects: every container with its contents is one rigid body (paper, section III-A4).

An object is assigned to a container only where the plan permits it, its rectangle meets the container's or the plan
demands it, and the opening has room for it beside the present contents. Overlap without permission is a collision.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from vcage.base.geometry import boxes_overlap, rotation_2d
from vcage.layout.cost import LayoutProblem
from vcage.layout.items import ITEMS, TableItem
from vcage.layout.placement.contents import CONTENT_MARGIN_M
from vcage.layout.relation_cost import RelatedBox, relation_terms
from vcage.layout.validation import as_rectangles
from vcage.objects.openings import Opening
from vcage.schema.plan import TABLE, Relation


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
    """(2,) floor area and volume that it takes of the free room, m² and m³; None where there is no room for it.

    On a bare surface the first object always has room.
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


class Groups:
    """Groups of containers with their contents.

    Attributes:
        container: id of the container that an object lies in or on, None on the table, by id.
        local: (2,) origin of every content in its container's frame, metres, by id; filled from the innermost on.
    """

    def __init__(self, items: Sequence[TableItem], relations: Sequence[Relation] = ()):
        self.items = {item.id: item for item in items}
        self.relations = relations
        lying = {(r.subject, r.reference) for r in relations if r.relation in ("inside", "on")}
        demanded = [item.id for item in items if (item.id, item.inside) in lying]
        self.container = assign_containers(items, demanded)
        self.local: dict[str, np.ndarray] = {}
        self._carried: dict[str, list[TableItem]] = {item.id: [] for item in items}
        for item in items:
            if (holder := self.container[item.id]) is not None:
                self._carried[holder].append(item)

    @property
    def roots(self) -> list[TableItem]:
        """The items that stand on the table."""
        return [item for item in self.items.values() if self.container[item.id] is None]

    def root(self, item: TableItem) -> TableItem:
        """The item that carries it on the table; itself where nothing does."""
        outer = self.container[item.id]
        return item if outer is None else self.root(self.items[outer])

    def contents(self, container: TableItem) -> list[TableItem]:
        """The items that lie directly in or on it."""
        return self._carried[container.id]

    def innermost_first(self) -> list[TableItem]:
        """The containers with contents; every one after its own contents."""
        holding = [item for item in self.items.values() if self.contents(item)]
        return sorted(holding, key=lambda item: -self._depth(item))

    def _depth(self, item: TableItem) -> int:
        outer = self.container[item.id]
        return 0 if outer is None else 1 + self._depth(self.items[outer])

    def release(self, item: TableItem, container: TableItem) -> None:
        """Take a content out of its container, onto the table."""
        self._carried[container.id].remove(item)
        self.container[item.id] = None

    def extent(self, item: TableItem, frame_yaw: float = 0.0) -> np.ndarray:
        """(2, 2) rectangle of an object and all that it carries, around its origin, in a frame turned by a yaw."""
        corners = [item.rectangle(frame_yaw)]
        for content in self.contents(item):
            corners.append(self.extent(content, frame_yaw) + rotation_2d(item.yaw - frame_yaw) @ self.local[content.id])
        return np.stack([np.min(corners, axis=(0, 1)), np.max(corners, axis=(0, 1))])

    def carried(self, item: TableItem) -> list[tuple[TableItem, np.ndarray]]:
        """The object itself and all that it carries, each with the (2,) way to its origin in the world's axes."""
        found = [(item, np.zeros(2))]
        for content in self.contents(item):
            way = rotation_2d(item.yaw) @ self.local[content.id]
            found += [(inner, way + further) for inner, further in self.carried(content)]
        return found

    def table_problem(
        self, workspace: np.ndarray, margin: float, allowed: Sequence[np.ndarray | None]
    ) -> LayoutProblem:
        """The problem of the items on the table.

        Args:
            workspace: (2, 2) bounds of every box; relations to the table mean its thirds, metres.
            margin: between boxes, metres.
            allowed: where each group may stand, see :meth:`allowed`.
        """
        roots = self.roots
        extents = np.array([self.extent(item) for item in roots])
        middles = extents.mean(axis=1)
        spots = self._spots(roots, middles) | {TABLE: RelatedBox.table(workspace)}
        return LayoutProblem(
            half=(extents[:, 1] - extents[:, 0]) / 2,
            target=np.array([item.target for item in roots]) + middles,
            bounds=workspace,
            margin=margin,
            allowed=tuple(allowed),
            extra=hand_gaps(roots, margin),
            relations=relation_terms(self.relations, spots, len(roots)),
            fixed=np.array([item.fixed for item in roots]) if any(item.fixed for item in roots) else None,
        )

    def container_problem(self, container: TableItem) -> LayoutProblem:
        """The problem of its contents in the container's own frame, where its walls are axis-aligned at any heading."""
        contents = self.contents(container)
        extents = np.array([self.extent(item, container.yaw) for item in contents])
        middles, half = extents.mean(axis=1), (extents[:, 1] - extents[:, 0]) / 2
        offsets = np.array([item.target for item in contents]) - container.target
        body = container.body_rectangle()
        spots = self._spots(contents, middles @ rotation_2d(container.yaw).T)
        # Of relations to its container only ``center`` makes sense.
        centred = [r for r in self.relations if r.relation == "center" or r.reference != container.id]
        spots[container.id] = RelatedBox(None, body.mean(axis=0), (body[1] - body[0]) / 2)
        return LayoutProblem(
            half=half,
            target=offsets @ rotation_2d(container.yaw) + middles,
            bounds=self.inner_bounds(container, half),
            margin=CONTENT_MARGIN_M,
            allowed=(None,) * len(contents),
            relations=relation_terms(centred, spots, len(contents), rotation_2d(container.yaw)),
        )

    def settle(self, container: TableItem, centres: np.ndarray) -> None:
        """Keep the solution (n, 2) of a container's problem as the local places of its contents."""
        for item, centre in zip(self.contents(container), centres, strict=True):
            self.local[item.id] = centre - self.extent(item, container.yaw).mean(axis=0)

    def inner_bounds(self, container: TableItem, half: np.ndarray) -> np.ndarray:
        """(2, 2) bounds of contents of half size (n, 2), in the container's frame.

        The opening; on a bare top, widened by as much as a single content may stick out.
        """
        contents = self.contents(container)
        centre, room = np.array(container.room.centre), np.array(container.room.size) / 2
        if len(contents) == 1 and container.bare and not fits_opening(contents[0], container):
            room = np.where(half[0] > room, half[0] + ITEMS.overhang_share * room, room)
        return np.stack([centre - room, centre + room])

    def _spots(self, members: Sequence[TableItem], middles: np.ndarray) -> dict[str, RelatedBox]:
        """Boxes of all items that the members carry, for relations; (n, 2) middles in the world's axes."""
        spots = {}
        for k, (member, middle) in enumerate(zip(members, middles, strict=True)):
            for item, way in self.carried(member):
                body = item.body_rectangle()
                spots[item.id] = RelatedBox(k, way + body.mean(axis=0) - middle, (body[1] - body[0]) / 2)
        return spots

    def allowed(self) -> tuple[list[np.ndarray | None], list[str]]:
        """(m, 2, 2) rectangles for the middle of each group on the table, None for anywhere; and the ids of what is
        carried that is nowhere it is allowed there."""
        found = [self._allowed(root) for root in self.roots]
        return [region for region, _ in found], [name for _, names in found for name in names]

    def _allowed(self, root: TableItem) -> tuple[np.ndarray | None, list[str]]:
        """(m, 2, 2) rectangles for the middle of a group from which all its members are in their allowed areas.

        Items that cannot be where they are allowed together with their carrier give way; their ids are returned.
        """
        meet, out_of_reach = None, []
        middle = self.extent(root).mean(axis=0)
        for item, way in self.carried(root):
            if item.allowed is None or root.fixed:
                continue
            shift = middle - way - item.rectangle().mean(axis=0)
            shifted = as_rectangles(item.allowed, f"where {item.id} may stand") + shift
            both = shifted if meet is None else intersections(meet, shifted)
            if meet is not None and not len(both):
                out_of_reach.append(item.id)
            else:
                meet = both
        return meet, out_of_reach

    def positions(
        self, roots: Sequence[TableItem], origins: np.ndarray, height: float
    ) -> dict[str, tuple[float, float, float]]:
        """(x, y, z) of every object when the roots' origins (n, 2) are on a table of that height, by id."""
        found: dict[str, tuple[float, float, float]] = {}
        for root, origin in zip(roots, origins, strict=True):
            found |= self._positions(root, np.array([*origin, height]))
        return {name: found[name] for name in self.items}

    def _positions(self, item: TableItem, at: np.ndarray) -> dict[str, tuple[float, float, float]]:
        """(x, y, z) of an object at ``at`` (3,) and of all that it carries, by id."""
        x, y, z = (float(v) for v in at)
        found = {item.id: (x, y, z)}
        for content in self.contents(item):
            way = rotation_2d(item.yaw) @ self.local[content.id]
            found |= self._positions(content, at + [*way, item.room.floor])
        return found


def hand_gaps(items: Sequence[TableItem], margin: float) -> np.ndarray | None:
    """(n, n) gaps beyond the margin between grasped items and those in the way of the palm; None for none."""
    heights = np.array([item.size[2] for item in items])
    low = np.array([np.inf if item.hand is None else item.hand.height for item in items])
    wanted = np.array([0.0 if item.hand is None else max(item.hand.gap - margin, 0.0) for item in items])
    touched = heights[None] > low[:, None]
    np.fill_diagonal(touched, False)
    gaps = np.where(touched, wanted[:, None], 0.0)
    return np.maximum(gaps, gaps.T) if touched.any() else None


def intersections(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(m, 2, 2) the rectangles that any of a (i, 2, 2) and any of b (j, 2, 2) share."""
    lower = np.maximum(a[:, None, 0], b[None, :, 0]).reshape(-1, 2)
    upper = np.minimum(a[:, None, 1], b[None, :, 1]).reshape(-1, 2)
    shared = np.all(lower <= upper, axis=1)
    return np.stack([lower[shared], upper[shared]], axis=1)
