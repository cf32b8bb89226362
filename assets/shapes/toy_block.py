"""Painted wooden toy blocks."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"red": (204, 44, 40), "blue": (36, 92, 196), "green": (40, 150, 70), "yellow": (242, 198, 40)}


def toy_block(name: str, variant: str, size: tuple[float, float, float], mass: float) -> BuiltObject:
    """A block with rounded edges.

    Args:
        name: of the object, for the seed of its texture.
        variant: a name of :data:`COLOURS`.
        size: along x, y and z, metres.
        mass: kilograms.
    """
    rng = variant_rng(name, variant)
    colour = np.array(COLOURS[variant])
    block = solids.rounded_box(size, 0.003)
    coat = materials.wood(rng, (tuple(colour * 0.86), tuple(np.minimum(colour * 1.05, 255))), 128)
    return BuiltObject([paint(block, coat, tiled(0.06), roughness=0.5)], [solids.box(size)], mass=mass, friction=0.8)
