"""The objects of the optimisation benchmark: the project's own, and what they have room for."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vcage.assets.asset import Asset
from vcage.assets.library import Library
from vcage.assets.openings import Opening
from vcage.igsc.layout.containers import LayoutItem
from vcage.schema.plan import RelationWord

SMALLEST_OPENING = 0.065
"""Openings narrower than this are for pens, metres."""


@dataclass(frozen=True)
class Kind:
    """An asset, and the opening that makes it a container."""

    asset: Asset
    opening: Opening | None
    word: RelationWord

    def item(
        self, id: str, yaw: float, target: np.ndarray, inside: str | None, allowed: np.ndarray | None
    ) -> LayoutItem:
        """What the optimiser is told about it, as the stage tells it."""
        size = tuple(float(x) for x in self.asset.size)
        return LayoutItem(id, size, yaw, (float(target[0]), float(target[1])), self.opening, inside, allowed)


def own_kinds(library: Library) -> list[Kind]:
    """The project's own kinds, so that the figures are the same on every machine, in their first variant."""
    names = [name for name in library.names if library.annotation(name).source == "parametric"]
    return [_kind(library.asset(name)) for name in names]


def _kind(asset: Asset) -> Kind:
    """Openings of what has moving parts, those that open sideways and narrow ones count as none."""
    point = next(iter(asset.annotation.functional_points), None)
    if point is None or asset.articulated or point.sideways:
        return Kind(asset, None, "on")
    opening = asset.opening(point, standing=True)
    if min(opening.size) < SMALLEST_OPENING or max(asset.size[:2]) <= 2 * SMALLEST_OPENING:
        return Kind(asset, None, "on")
    if point.holds == "in":
        return Kind(asset, opening, "inside")
    return Kind(asset, replace(opening, rim=np.inf), "on")
