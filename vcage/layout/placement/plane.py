"""One plane of footprints to be placed: the table top, or the floor of a container in its own frame.

The problem as arrays; :mod:`~vcage.layout.placement.arrangement` holds partial solutions,
:mod:`~vcage.layout.placement.search` finds them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from vcage.base.geometry import footprint_half_size
from vcage.layout.items import TableItem, centres_within
from vcage.layout.placement.free_region import TOLERANCE, FreeRegion, free_region
from vcage.layout.validation import as_rectangles

if TYPE_CHECKING:
    from vcage.layout.placement.related import Related

Unions = Callable[[TableItem, float], Sequence[np.ndarray]]
"""(m, 2, 2) unions of rectangles, one of each of which must hold an item's centre at a yaw."""


@dataclass(frozen=True)
class Stance:
    """Headings at which an item needs the same room.

    Args:
        half: (2,) half size of its axis-aligned rectangle, metres.
        yaws: radians.
        unions: (m, 2, 2) each; its centre must lie in one rectangle of each.
    """

    half: np.ndarray
    yaws: tuple[float, ...]
    unions: tuple[np.ndarray, ...] = ()

    @property
    def area(self) -> float:
        """Area of the rectangle, m²."""
        return 4 * float(self.half[0]) * float(self.half[1])


@dataclass(frozen=True, eq=False)
class Plane:
    """Items to be placed in bounds among obstacles.

    Args:
        items: to place; a container with its contents counts as one.
        stances: of each item, the smallest rectangle first.
        bounds: (2, 2) that every rectangle stays within.
        margin: smallest gap between two rectangles, metres.
        obstacles: (m, 2, 2) rectangles that are taken.
        related: relations between the items that are kept; None for none.
        container: id of the object whose opening it is; None for the table.
    """

    items: Sequence[TableItem]
    stances: Sequence[Sequence[Stance]]
    bounds: np.ndarray
    margin: float
    obstacles: np.ndarray
    related: Related | None = None
    container: str | None = None

    @property
    def where(self) -> str:
        """The plane in words."""
        return f"the opening of {self.container}" if self.container else "the workspace"

    @cached_property
    def areas(self) -> np.ndarray:
        """(n,) smallest area of every item, grown by half a margin on all sides, m²."""
        return np.array([float((2 * stances[0].half + self.margin).prod()) for stances in self.stances])

    @cached_property
    def order(self) -> list[int]:
        """Indices of the items, largest first."""
        return sorted(range(len(self.items)), key=lambda k: (-self.areas[k], self.items[k].id))

    @cached_property
    def available(self) -> float:
        """Area of the bounds, grown by half a margin like the items, without the obstacles, m²."""
        half = self.margin / 2
        grown = self.bounds + np.array([[-half], [half]])
        return free_region(grown, np.zeros(2), self.obstacles, half).area

    @cached_property
    def compact(self) -> list[list[Stance]]:
        """Stances of each item for packing: the smallest two possible alone, along and across."""
        return [list(islice((s for s in stances if not self.alone(s).is_empty), 2)) for stances in self.stances]

    def alone(self, stance: Stance) -> FreeRegion:
        """Region of an item's centre at a stance while no other item is placed."""
        return free_region(self.bounds, stance.half, self.obstacles, self.margin, stance.unions)

    @property
    def needed(self) -> float:
        """Area that the items take at their smallest, with margins, m²."""
        return float(self.areas.sum())

    def only(self, indices: Sequence[int]) -> Plane:
        """The same plane with those items alone."""
        return replace(self, items=[self.items[k] for k in indices], stances=[self.stances[k] for k in indices])

    def enlarged(self, by: np.ndarray) -> Plane:
        """The same plane with bounds that are longer by (2,) metres, half of it on each side."""
        return replace(self, bounds=self.bounds + np.outer((-0.5, 0.5), by))


def make_plane(
    items: Sequence[TableItem],
    bounds: np.ndarray,
    margin: float,
    obstacles: np.ndarray,
    unions: Unions,
    related: Related | None = None,
) -> Plane:
    """The plane of ``items``; ``unions`` says where a centre may be, besides the item's own ``within``."""
    return Plane(items, [_stances(item, unions) for item in items], bounds, margin, obstacles, related)


def _stances(item: TableItem, unions: Unions) -> list[Stance]:
    """Stances of an item, the smallest rectangle first."""
    found: dict[tuple, tuple[np.ndarray, list[float], Sequence[np.ndarray]]] = {}
    halves = footprint_half_size(item.size[:2], np.array(item.yaws))  # (yaws, 2)
    equal = np.round(halves / TOLERANCE).tolist()
    for half, yaw, (x, y) in zip(halves, item.yaws, equal, strict=True):
        where = unions(item, yaw)
        found.setdefault((x, y, *map(id, where)), (half, [], where))[1].append(float(yaw))
    stances = [
        Stance(half, tuple(yaws), (*where, *_centres_in_view(item, half))) for half, yaws, where in found.values()
    ]
    return sorted(stances, key=lambda stance: stance.area)


def _centres_in_view(item: TableItem, half: np.ndarray) -> tuple[np.ndarray, ...]:
    """Rectangles of the centre for which the whole rectangle lies in one of the item's ``within``."""
    if item.within is None:
        return ()
    return (centres_within(as_rectangles(item.within, f"where {item.id} is seen"), half),)
