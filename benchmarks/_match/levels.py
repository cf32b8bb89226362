"""The levels of difficulty."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Level:
    """Changes of a target picture beside moving and turning every object.

    Args:
        light: other direction, strength and warmth of the light, and painted shadows.
        colour: see :func:`benchmarks._match.changes.drift_colours`.
        blur: see :func:`benchmarks._match.changes.soften`.
        warp: see :func:`benchmarks._match.changes.bend`.
        table: another painted table top.
        stranger: something is added that the scene does not have, and one object is missing.
        touching: pairs and threes of objects touch.
    """

    light: bool = False
    colour: bool = False
    blur: bool = False
    warp: bool = False
    table: bool = False
    stranger: bool = False
    touching: bool = False


LEVELS: dict[str, Level] = {
    "moved": Level(),
    "light": Level(light=True),
    "colour": Level(colour=True),
    "blur": Level(blur=True),
    "warp": Level(warp=True),
    "table": Level(table=True),
    "stranger": Level(stranger=True),
    "touching": Level(touching=True),
    "hardest": Level(light=True, colour=True, blur=True, warp=True, table=True, stranger=True, touching=True),
}
"""The rows of the table, the easiest first."""
