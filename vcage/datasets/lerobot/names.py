"""Names of a vector's numbers, in the ways in which ``meta/info.json`` of a LeRobot data set has them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def number_names(names: Any) -> list[str]:
    """The names as a list: they also come in groups, ``{"motors": […]}``, or numbered, ``{"x": 0}``; none for None."""
    if isinstance(names, Mapping):
        names = [one for name, group in names.items() for one in (group if isinstance(group, list) else [name])]
    return [str(name) for name in names or ()]
