"""Buttons that a closed hand pushes down and a spring lifts."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import MovingPart, paint
from vcage.schema.asset import Joint


def button_joint(origin: tuple[float, float, float], travel_m: float) -> Joint:
    """The joint of a button: pushed down by so much, and lifted by a spring."""
    return Joint(
        kind="slide",
        origin=origin,
        axis=(0.0, 0.0, -1.0),
        lower=0.0,
        upper=travel_m,
        damping=3.0,
        friction=0.0,
        spring=400.0,
    )


def push_button(
    rng: np.random.Generator, size: tuple[float, float, float], bottom: tuple[float, float, float], colour: Colour
) -> MovingPart:
    """A block with rounded edges that sinks by 5 mm; leave 6 mm free below it.

    Args:
        rng: for the surface.
        size: (3,) metres.
        bottom: (3,) the middle of its lower face, not pushed.
        colour: RGB.
    """
    block = solids.rounded_box(size, 0.0015, bottom, steps=2)
    skin = paint(block, materials.plastic(rng, colour), tiled(0.05), roughness=0.4)
    return MovingPart("button", [skin], [solids.box(size, bottom)], mass=0.006, joint=button_joint(bottom, 0.005))
