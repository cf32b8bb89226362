"""Parametric builders: one function per kind of object, from a variant's id to its geometry."""

from __future__ import annotations

from collections.abc import Callable

from vcage.objects.builders import (
    appliances,
    bath_things,
    bathroom,
    boxes,
    boxes_lidded,
    breads,
    cabinets,
    cash_drawers,
    checkout,
    clocks,
    cookware,
    cosmetics,
    counter,
    crockery,
    desk_supplies,
    desk_tidies,
    desk_tools,
    devices,
    eggs,
    fruits,
    groceries,
    household,
    jars,
    kitchen_tools,
    produce,
    products,
    round_products,
    snacks,
    stationery,
    taps_and_bells,
    toiletries,
    tools,
    toys,
    treats,
)
from vcage.objects.builders.parts import BuiltObject

Builder = Callable[[str], BuiltObject]

FAMILIES: tuple[dict[str, Builder], ...] = (
    appliances.BUILDERS,
    bath_things.BUILDERS,
    bathroom.BUILDERS,
    boxes.BUILDERS,
    boxes_lidded.BUILDERS,
    breads.BUILDERS,
    cabinets.BUILDERS,
    cash_drawers.BUILDERS,
    checkout.BUILDERS,
    clocks.BUILDERS,
    cookware.BUILDERS,
    cosmetics.BUILDERS,
    counter.BUILDERS,
    crockery.BUILDERS,
    desk_supplies.BUILDERS,
    desk_tidies.BUILDERS,
    desk_tools.BUILDERS,
    devices.BUILDERS,
    eggs.BUILDERS,
    fruits.BUILDERS,
    groceries.BUILDERS,
    household.BUILDERS,
    jars.BUILDERS,
    kitchen_tools.BUILDERS,
    produce.BUILDERS,
    products.BUILDERS,
    round_products.BUILDERS,
    snacks.BUILDERS,
    stationery.BUILDERS,
    taps_and_bells.BUILDERS,
    toiletries.BUILDERS,
    tools.BUILDERS,
    toys.BUILDERS,
    treats.BUILDERS,
)

BUILDERS: dict[str, Builder] = {name: builder for family in FAMILIES for name, builder in family.items()}
"""Asset name → builder; the argument is the id of a variant."""
