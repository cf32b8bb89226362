"""Table items of tests, by what their tests are about."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from vcage.layout.items import TableItem
from vcage.objects.openings import Opening


def unplaced(name: str, size: Sequence[float], yaws: Sequence[float] = (0.0,), **fields: Any) -> TableItem:
    """What is to be placed, of a footprint (x, y); its height decides nothing."""
    return TableItem(name, (*size, 0.1), tuple(yaws), **fields)


def standing_at(
    id: str, size: tuple, yaw: float, target: Sequence[float], opening: Opening | None = None, **fields: Any
) -> TableItem:
    """What is to be optimised, at its heading and target."""
    return TableItem(id, size, (yaw,), (target[0], target[1]), opening, **fields)
