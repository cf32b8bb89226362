"""What a plan's check, a placement and a layout need of assets: sizes and openings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vcage.layout.items import BARE, TableItem, table_item
from vcage.objects.asset import Asset
from vcage.objects.openings import Opening
from vcage.plans.check import Capacity
from vcage.schema.asset import FunctionalPoint


def room_of(asset: Asset) -> Capacity:
    """Size of an asset, and the opening or surface that layouts use of it."""
    size = tuple(float(x) for x in asset.size)
    point = _used_point(asset)
    if point is None:
        return Capacity(size)
    opening = asset.opening(point)
    return Capacity(
        size,
        point.holds,
        opening.size,
        opening.centre,
        ceiling=opening.depth if point.holds == "in" and point.sideways else None,
        bare=point.holds != "in" and opening.floor >= size[2] - BARE,
    )


def capacity_of(name: str, asset: Asset) -> TableItem:
    """The room that an asset needs, and the widest opening or surface that layouts use of it."""
    point = _used_point(asset)
    if point is None:
        return table_item(name, asset)
    opening = asset.opening(point)
    roof = opening.depth if point.holds == "in" and point.sideways else None
    if point.holds != "in":
        opening = replace(opening, rim=np.inf)
    return table_item(name, asset, opening=opening, ceiling=roof)


def opening_for(asset: Asset, contents: Sequence[Asset] = ()) -> Opening | None:
    """The opening that a layout may use of an asset, in the object's frame; None without one.

    What stands in it as a box does not touch a sloping wall. Where one of the contents is too large for that, the
    wider opening of what is let go there: whether it holds is then for the simulator to say.

    Returns:
        Its rim is infinitely high where things stand on it, not in it.
    """
    point = _used_point(asset)
    if point is None:
        return None
    if point.holds != "in":
        return replace(asset.opening(point), rim=np.inf)
    narrow = asset.opening(point, standing=True)
    fits = all(np.all(np.sort(content.footprint) <= np.sort(narrow.size)) for content in contents)
    return narrow if fits else asset.opening(point)


def _used_point(asset: Asset) -> FunctionalPoint | None:
    """The first functional point, unless it is in a moving part: at the start drawers are closed and take nothing."""
    point = next(iter(asset.annotation.functional_points), None)
    return None if point is None or point.link is not None else point
