"""What a plan's check, a placement and a layout need of assets: sizes and openings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vcage.assets.asset import Asset
from vcage.assets.openings import Opening
from vcage.schema.plan_check import Room


def room_of(asset: Asset) -> Room:
    """Size of an asset, and the opening or surface of its first functional point: the one that layouts use."""
    size = tuple(float(x) for x in asset.size)
    points = asset.annotation.functional_points
    if not points:
        return Room(size)
    opening = asset.opening(points[0])
    roofed = points[0].holds == "in" and points[0].sideways
    return Room(size, points[0].holds, opening.size, opening.centre, opening.depth if roofed else None)


def opening_for(asset: Asset, contents: Sequence[Asset] = ()) -> Opening | None:
    """The opening that a layout may use of an asset's first functional point, in the object's frame; None without one.

    What stands in it as a box does not touch a sloping wall. Where one of the contents is too large for that, the
    wider opening of what is let go there: whether it holds is then for the simulator to say.

    Returns:
        Its rim is infinitely high where things stand on it, not in it.
    """
    point = next(iter(asset.annotation.functional_points), None)
    if point is None:
        return None
    if point.holds != "in":
        return replace(asset.opening(point), rim=np.inf)
    narrow = asset.opening(point, standing=True)
    fits = all(np.all(np.sort(content.footprint) <= np.sort(narrow.size)) for content in contents)
    return narrow if fits else asset.opening(point)
