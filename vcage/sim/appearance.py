"""How a rendered world looks; physics never depends on it, so a recording can be drawn again in another light."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

LinearColour = tuple[float, float, float]


@dataclass(frozen=True)
class Appearance:
    """Light, textures and colours of a rendered world. Colours are linear RGB.

    Args:
        table_texture: (H, W, 3) uint8 sRGB picture that covers the table top once, or None for ``table_colour``.
        table_colour: of the top without a texture, and of its edge and legs.
        floor_colour, wall_colour: of the surroundings.
        light_direction: in which the key light shines, world frame; towards the robot (-y), so that the arms throw
            their shadows away from the table.
        light_colour: of the key light; values above 1 are brighter.
        ambient: light from everywhere.
        shadows: whether things throw shadows.
    """

    table_texture: np.ndarray | None = field(default=None, repr=False)
    table_colour: LinearColour = (0.36, 0.24, 0.14)
    floor_colour: LinearColour = (0.30, 0.29, 0.28)
    wall_colour: LinearColour = (0.55, 0.56, 0.57)
    light_direction: tuple[float, float, float] = (0.25, -0.4, -1.0)
    light_colour: LinearColour = (1.6, 1.55, 1.5)
    ambient: LinearColour = (0.45, 0.45, 0.47)
    shadows: bool = True

    @classmethod
    def random(cls, rng: np.random.Generator, textures: Sequence[Callable[[], np.ndarray]] = ()) -> Appearance:
        """A moderate variation: direction, strength and warmth of the light, table texture, floor and wall.

        Args:
            rng: source of every choice.
            textures: paint the table pictures to choose from; the plain table colour varies when there are none.
        """
        heading, slant = rng.uniform(-np.pi + 0.4, -0.4), rng.uniform(0.25, 0.6)
        strength, warmth = rng.uniform(1.3, 1.8), rng.uniform(-0.08, 0.08)
        level = rng.uniform(0.38, 0.52)
        floor, wall = rng.uniform(0.15, 0.45), rng.uniform(0.4, 0.7)
        tint = rng.uniform(0.9, 1.1, size=(2, 3))
        base = cls()
        return cls(
            table_texture=textures[int(rng.integers(len(textures)))]() if textures else None,
            table_colour=_colour(np.array(base.table_colour) * rng.uniform(0.7, 1.3)),
            floor_colour=_colour(floor * tint[0]),
            wall_colour=_colour(wall * tint[1]),
            light_direction=_colour([slant * np.cos(heading), slant * np.sin(heading), -1.0]),
            light_colour=_colour(strength * np.array([1 + warmth, 1.0, 1 - warmth])),
            ambient=_colour(level * np.array([1 + warmth / 3, 1.0, 1 - warmth / 3])),
        )


def _colour(values: Sequence[float] | np.ndarray) -> LinearColour:
    red, green, blue = (float(x) for x in values)
    return red, green, blue
