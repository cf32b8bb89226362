"""Table items of tests, by what their tests are about."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from vcage.layout.items import TableItem
from vcage.objects.openings import Opening


def unplaced(name: str, size: Sequence[float], yaws: Sequence[float] = (0.0,), **fields: Any) -> TableItem:
    """What is to be placed, of a footprint (x, y); its height decides nothing."""
    return TableItem(name, (*size, 0.1), tuple(yaws), **fields)


def capacity(
    size: Sequence[float],
    holds: str | None = None,
    opening: tuple[float, float] = (0.0, 0.0),
    ceiling: float | None = None,
    bare: bool = False,
) -> TableItem:
    """Inputs of the size checks: ``in`` or ``on``, and the available room."""
    x, y, z = size
    rim = math.inf if holds == "on" else z
    room = Opening((0.0, 0.0), opening, z if bare else 0.0, rim) if holds else None
    return TableItem("item", (x, y, z), opening=room, ceiling=ceiling)


def standing_at(
    id: str, size: tuple, yaw: float, target: Sequence[float], opening: Opening | None = None, **fields: Any
) -> TableItem:
    """What is to be optimised, at its heading and target."""
    return TableItem(id, size, (yaw,), (target[0], target[1]), opening, **fields)


TRAY = Opening(centre=(0.0, 0.0), size=(0.26, 0.16), floor=0.01, rim=math.inf)


def tray(name: str = "tray", **fields) -> TableItem:
    return standing_at(
        **{"id": name, "size": (0.3, 0.2, 0.03), "yaw": 0.0, "target": (0, 0), "opening": TRAY, **fields}
    )


def roll(name: str = "roll", **fields) -> TableItem:
    return standing_at(
        **{"id": name, "size": (0.1, 0.06, 0.05), "yaw": 0.0, "target": (0.02, 0), "inside": "tray", **fields}
    )
