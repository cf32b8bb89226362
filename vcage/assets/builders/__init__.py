"""Parametric builders: one function per kind of object, from a variant's id to its geometry."""

from __future__ import annotations

from collections.abc import Callable

from vcage.assets.builders import (
    bathroom,
    boxes,
    breads,
    crockery,
    desk_tools,
    fruits,
    groceries,
    stationery,
    toys,
)
from vcage.assets.builders.parts import BuiltObject

Builder = Callable[[str], BuiltObject]

FAMILIES: tuple[dict[str, Builder], ...] = (
    bathroom.BUILDERS,
    boxes.BUILDERS,
    breads.BUILDERS,
    crockery.BUILDERS,
    desk_tools.BUILDERS,
    fruits.BUILDERS,
    groceries.BUILDERS,
    stationery.BUILDERS,
    toys.BUILDERS,
)

BUILDERS: dict[str, Builder] = {name: builder for family in FAMILIES for name, builder in family.items()}
"""Asset name → builder; the argument is the id of a variant."""
