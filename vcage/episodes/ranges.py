"""The ranges of randomisation that a collection draws from."""

from __future__ import annotations

from vcage.base.errors import UsageError
from vcage.schema.randomisation import Randomisation
from vcage.sim.robots import load_randomisation


def required_ranges(randomise: str, layout: str, lone: bool = False) -> Randomisation:
    """Load ranges, and require layouts that give room to other variants and clutter.

    Args:
        randomise: name or file of the ranges.
        layout: ``varied`` or ``fixed``.
        lone: True if a script runs alone, which has no plan to draw layouts by.

    Raises:
        UsageError: layouts are not drawn, but the ranges need them.
        UnknownName, MissingStage, InputFileError: there are no such ranges, or they are not possible.
    """
    ranges = load_randomisation(randomise)
    if (ranges.world.variants or ranges.world.clutter[1]) and (layout == "fixed" or lone):
        raise UsageError(
            f"{ranges.name} asks for other variants or for clutter, which need layouts that are drawn"
            + (", and a sub-task that runs alone has none" if lone else ", not --layout fixed"),
            hint="leave out --layout, or give --randomise a file with variants: false and clutter: [0, 0]",
        )
    return ranges
