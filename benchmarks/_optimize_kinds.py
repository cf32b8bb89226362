"""The objects of the optimisation benchmark: the project's own, and what they have room for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vcage.layout.capacities import opening_for
from vcage.layout.items import HandClearance, TableItem, table_item
from vcage.objects.asset import Asset
from vcage.objects.library import Library
from vcage.objects.openings import Opening
from vcage.schema.plan import RelationWord

SMALLEST_OPENING = 0.065
"""Openings narrower than this are for pens, metres."""


@dataclass(frozen=True)
class Kind:
    """An asset, the rectangle that it needs, and the opening that makes it a container."""

    asset: Asset
    room: TableItem
    opening: Opening | None
    word: RelationWord

    @property
    def interior(self) -> Opening:
        """The opening of a container.

        Raises:
            ValueError: it is none.
        """
        if self.opening is None:
            raise ValueError(f"{self.asset.name} holds nothing")
        return self.opening

    @cached_property
    def rectangle(self) -> np.ndarray:
        """(2, 2) lower and upper corner of the room in the object's frame, metres."""
        centre, size = np.array(self.room.centre), np.array(self.room.size[:2])
        return np.stack([centre - size / 2, centre + size / 2])

    def item(
        self,
        id: str,
        yaw: float,
        target: np.ndarray,
        inside: str | None,
        allowed: np.ndarray | None,
        hand: HandClearance | None = None,
    ) -> TableItem:
        """The item for the optimiser, as the stage makes it: the swept room, its middle and the body in it.

        The stage also gives openings that take no contents; to the optimiser that is the same.
        """
        return replace(
            self.room,
            id=id,
            yaws=(yaw,),
            target=(float(target[0]), float(target[1])),
            opening=self.opening,
            inside=inside,
            allowed=allowed,
            hand=hand,
        )


def own_kinds(library: Library) -> list[Kind]:
    """The project's own kinds, so that the figures are the same on every machine, in their first variant."""
    names = [name for name in library.names if library.annotation(name).source == "parametric"]
    return [_kind(library.asset(name)) for name in names]


def _kind(asset: Asset) -> Kind:
    """Openings of articulated objects; narrow ones and those that open sideways do not count."""
    point = next(iter(asset.annotation.functional_points), None)
    plain = Kind(asset, table_item(asset.name, asset), None, "on")
    if point is None or asset.articulated or point.sideways:
        return plain
    opening = opening_for(asset)
    if opening is None or min(opening.size) < SMALLEST_OPENING or max(asset.size[:2]) <= 2 * SMALLEST_OPENING:
        return plain
    return Kind(asset, plain.room, opening, "inside" if point.holds == "in" else "on")
