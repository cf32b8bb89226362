"""The look of a rendered world. Physics never depends on it, so a recording can be drawn again in another light."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from vcage.schema.randomisation import CameraShift, Tint

LinearColour = tuple[float, float, float]

Direction = tuple[float, float, float]
"""In the world, of any length."""


@dataclass(frozen=True)
class Appearance:
    """Light, textures and colours of a rendered world. Colours are linear RGB.

    Args:
        table_texture: (H, W, 3) uint8 sRGB picture that covers the table top once, or None for ``table_colour``.
        table_colour: of the top without a texture, and of its edge and legs.
        floor_texture, wall_texture: the same as pictures that repeat (:mod:`vcage.objects.surface_pictures`), or None
            for the colours.
        floor_colour, wall_colour: of the surroundings without a picture.
        light_direction: of the key light, world frame; towards the robot (-y), so that the arms throw their shadows
            away from the table.
        light_colour: of the key light; values above 1 are brighter.
        ambient: light from all directions.
        shadows: the key light throws shadows.
        further_lights: (direction, colour) of up to two more lights without shadows.
        tints: changes of the colours of objects, by id.
        cameras: shifts of the robot's cameras from the poses in its file, by name.
    """

    table_texture: np.ndarray | None = field(default=None, repr=False)
    table_colour: LinearColour = (0.36, 0.24, 0.14)
    floor_colour: LinearColour = (0.30, 0.29, 0.28)
    wall_colour: LinearColour = (0.55, 0.56, 0.57)
    light_direction: Direction = (0.25, -0.4, -1.0)
    light_colour: LinearColour = (1.6, 1.55, 1.5)
    ambient: LinearColour = (0.45, 0.45, 0.47)
    shadows: bool = True
    further_lights: tuple[tuple[Direction, LinearColour], ...] = ()
    floor_texture: np.ndarray | None = field(default=None, repr=False)
    wall_texture: np.ndarray | None = field(default=None, repr=False)
    tints: Mapping[str, Tint] = field(default_factory=dict)
    cameras: Mapping[str, CameraShift] = field(default_factory=dict)
