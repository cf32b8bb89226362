"""Starting places for a plan: each object at the free point nearest to the optimum of its relations.

References are placed before their subjects. The free area is exact: rectangles in the workspace and in view, clear of
the others by a gap, or by the room of a hand, and clear of everything they hide in the picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vcage.layout.groups import hand_gaps
from vcage.layout.items import TableItem, centres_within
from vcage.layout.placement.free_region import FreeRegion, free_region
from vcage.layout.placement.view import view_rectangles
from vcage.plans.relations import DIRECTIONS, hold, hold_on_table
from vcage.schema.plan import TABLE, Relation, RelationWord
from vcage.schema.scene import Scene


@dataclass(frozen=True)
class StartSettings:
    """Settings of starting places.

    Args:
        gap_m: free space between neighbours at its best: the picture shows the table between them.
        border_px: width that stays free between an object and the edge of the picture.
        behind_m: largest distance behind the middle of the table for an object planned in the middle: others stand
            before it.
        broken_cost_m: cost of a broken relation, more than any distance.
        staying_share: cost of a metre from where an object stands now, beside a metre from where a relation looks best.
    """

    gap_m: float = 0.03
    border_px: float = 3.0
    behind_m: float = 0.05
    broken_cost_m: float = 1e3
    staying_share: float = 0.05


SETTINGS = StartSettings()


def starting_places(
    scene: Scene, items: Sequence[TableItem], relations: Sequence[Relation], gap: float
) -> list[TableItem]:
    """The items at targets clear of each other where there is room, satisfying the relations.

    Args:
        scene: whose table, workspace and camera it is.
        items: on the table, at their headings and where they stand now; fixed items stay there.
        relations: between them, and to the table.
        gap: between any two, metres.
    """
    starts = _Starts(scene, relations, gap)
    done = {item.id: item for item in items if item.fixed}
    waiting = {item.id: item for item in items if not item.fixed}
    for name in _ordered(list(waiting), relations):
        done[name] = starts.put(waiting[name], list(done.values()))
    return list(done.values())


def _ordered(waiting: list[str], relations: Sequence[Relation]) -> list[str]:
    """References before subjects, otherwise in the plan's order, and unplanned objects last."""
    first = list(dict.fromkeys(r.subject for r in relations))
    waiting = sorted(waiting, key=lambda name: first.index(name) if name in first else len(first))
    order: list[str] = []
    while waiting:
        ready = [n for n in waiting if not any(r.subject == n and r.reference in waiting for r in relations)]
        order.append((ready or waiting)[0])
        waiting.remove(order[-1])
    return order


class _Starts:
    """Free places on one table that suit the relations."""

    def __init__(self, scene: Scene, relations: Sequence[Relation], gap: float):
        self._relations, self._gap = relations, gap
        self._camera, self._height = scene.top_camera.camera(), scene.table.height
        self._table = scene.table.rectangle
        self._workspace = np.array([scene.workspace.lower, scene.workspace.upper])

    def put(self, item: TableItem, others: Sequence[TableItem]) -> TableItem:
        """The item at the best of the free points nearest to the optimum of its relations, and of the corners
        of the free area; without a free area, in the workspace."""
        rectangle = item.rectangle()
        middle, half = rectangle.mean(axis=0), (rectangle[1] - rectangle[0]) / 2
        wishes = self._wishes(item, others)
        points = [np.array(item.target), *(point for wish in wishes for point in wish.points)]
        points += [np.mean(points[1:], axis=0)] if len(wishes) > 1 else []
        region = self._region(item, others)
        if region.is_empty:
            lower, upper = self._workspace[0] + half, self._workspace[1] - half
            lower, upper = np.minimum(lower, (lower + upper) / 2), np.maximum(upper, (lower + upper) / 2)
            at = np.array([np.clip(point + middle, lower, upper) for point in points]) - middle
        else:
            free = [region.nearest(point + middle) for point in points]
            at = np.array([*free, *(region.corners() if wishes else ())]) - middle
        costs = SETTINGS.staying_share * np.linalg.norm(at - item.target, axis=1)
        for wish in wishes:
            costs = costs + wish.costs(at)
        x, y = (float(v) for v in at[int(np.argmin(costs))])
        return replace(item, target=(x, y))

    def _wishes(self, item: TableItem, others: Sequence[TableItem]) -> list[_Wish]:
        """Wishes of the relations to items that have their places already."""
        body = item.body_rectangle()
        around = {other.id: other.body_rectangle() + other.target for other in others}
        found: list[_Wish] = []
        for r in self._relations:
            other = r.reference if r.subject == item.id else r.subject
            if r.subject == item.id and other == TABLE:
                found.append(_TableWish(r.relation, body, self._workspace, 1, self._middle(body)))
            elif item.id in (r.subject, r.reference) and other in around:
                found.append(_Wish(r.relation, body, around[other], 1 if other == r.reference else -1))
        return found

    def _middle(self, body: np.ndarray) -> np.ndarray:
        """(2,) best place for a body in the middle of the table: with room before it."""
        x, y = self._table.mean(axis=0)
        behind = self._workspace[1, 1] - y - (body[1, 1] - body[0, 1]) / 2
        return np.array([x, y + np.clip(0.3 * behind, 0.0, SETTINGS.behind_m)])

    def _region(self, item: TableItem, others: Sequence[TableItem]) -> FreeRegion:
        """Region of the middle of an item's rectangle among others.

        With room for a hand, a free view and all of the item in view; unsatisfiable demands are given up in that order.
        """
        half = item.half_size()
        taken = np.array([other.rectangle() + other.target for other in others]).reshape(-1, 2, 2)
        hiding = np.concatenate([taken, self._hiding(item, others, taken)])
        gaps, none = np.full(len(others), self._gap), np.zeros(len(others))
        room, seen = hand_gaps([item, *others], self._gap), self._centres_in_view(item, half)
        wide = gaps if room is None else gaps + room[0, 1:]
        tries = (
            (hiding, np.concatenate([wide, none]), seen),
            (hiding, np.concatenate([gaps, none]), seen),
            (taken, gaps, seen),
            (taken, gaps, ()),
        )
        regions = (free_region(self._workspace, half, *kept) for kept in tries)
        return next((region for region in regions if not region.is_empty), FreeRegion.nowhere())

    def _hiding(self, item: TableItem, others: Sequence[TableItem], taken: np.ndarray) -> np.ndarray:
        """(n, 2, 2) rectangles in which the item would hide others, at (n, 2, 2), in the picture, or they it.

        Seen from the camera, a high object also covers the table behind it: its rectangle, stretched away
        from the point below the camera.
        """
        eye, above = self._camera.pose.p[:2], self._camera.pose.p[2] - self._height
        heights = np.array([other.size[2] for other in others]).reshape(-1, 1, 1)
        shown = _around(taken, eye + (taken - eye) * above / np.maximum(above - heights, 1e-6))
        # The item's own rectangle is stretched likewise: it meets visible objects where the unstretched one meets this.
        return _around(shown, eye + (shown - eye) * max(above - item.size[2], 1e-6) / above)

    def _centres_in_view(self, item: TableItem, half: np.ndarray) -> tuple[np.ndarray, ...]:
        """Unions of rectangles, each of which must contain the middle for the picture to show all of the item."""
        (x0, y0), (x1, y1) = self._workspace
        top = self._height + item.size[2]
        corners = self._camera.project([(x, y, z) for x in (x0, x1) for y in (y0, y1) for z in (self._height, top)])
        if np.all(corners >= SETTINGS.border_px) and np.all(
            corners <= [self._camera.width - SETTINGS.border_px, self._camera.height - SETTINGS.border_px]
        ):
            return ()  # all of the workspace is in view, as mostly
        seen = view_rectangles(self._camera, self._height, item.size[2], self._workspace, SETTINGS.border_px)
        return (centres_within(seen, half),)


@dataclass(frozen=True)
class _Wish:
    """The wish of a relation for an object beside a placed one.

    Args:
        word: the relation.
        body: (2, 2) rectangle of the object around its origin.
        other: (2, 2) rectangle of the placed object, in the world.
        sign: 1 where the object is the relation's subject, −1 where it is its reference.
    """

    word: RelationWord
    body: np.ndarray
    other: np.ndarray
    sign: int

    @cached_property
    def points(self) -> np.ndarray:
        """(k, 2) origins of the object at which the relation looks its best."""
        reach = (self.other[1] - self.other[0] + self.body[1] - self.body[0]) / 2
        words = [self.word] if self.word in DIRECTIONS else list(DIRECTIONS)
        ways = self.sign * np.array([DIRECTIONS[word] for word in words]) * (reach + SETTINGS.gap_m)
        if self.word == "center":
            ways = np.zeros((1, 2))
        return self.other.mean(axis=0) + ways - self.body.mean(axis=0)

    def costs(self, at: np.ndarray) -> np.ndarray:
        """(n,) costs of origins (n, 2): metres from the nearest best one, more where the relation breaks."""
        away = np.linalg.norm(at[:, None] - self.points, axis=2).min(axis=1)
        return away + np.where(self._relation_holds(self.body + at[:, None]), 0.0, SETTINGS.broken_cost_m)

    def _relation_holds(self, boxes: np.ndarray) -> np.ndarray:
        """(n,) bool: the relation holds of the object with rectangles (n, 2, 2)."""
        other = self.other[None]
        return hold(self.word, boxes, other) if self.sign == 1 else hold(self.word, other, boxes)


@dataclass(frozen=True)
class _TableWish(_Wish):
    """Constraint of a relation to the table: ``other`` is what may be covered of it.

    Args:
        middle: (2,) where the middle of the object is best in ``center``, metres.
    """

    middle: np.ndarray

    @cached_property
    def points(self) -> np.ndarray:
        """(k, 2) origins of the object at which it stands in the middle of its third."""
        lower, upper = self.other
        at = self.middle[None]
        if self.word in DIRECTIONS:
            third = (upper - lower) / 3 * DIRECTIONS[self.word]
            along = np.abs(np.array(DIRECTIONS[self.word])[::-1]) * (upper - lower) / 4
            at = (lower + upper) / 2 + third + np.outer((-1, 0, 1), along)
        return at - self.body.mean(axis=0)

    def _relation_holds(self, boxes: np.ndarray) -> np.ndarray:
        return hold_on_table(self.word, boxes, self.other)


def _around(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(n, 2, 2) the rectangles around each two of two lists."""
    return np.stack([np.minimum(a[:, 0], b[:, 0]), np.maximum(a[:, 1], b[:, 1])], axis=1)
