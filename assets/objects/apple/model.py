"""An apple of 0.066 m with a stem, standing on its five bumps."""

from __future__ import annotations

import numpy as np

from assets.shapes.lumps import standing
from vcage.objects.modelling import materials, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.noise import Colour, blend, clouds, noise, over
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"red": ((168, 24, 28), (216, 84, 48)), "green": ((116, 164, 50), (170, 200, 92))}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("apple", variant)
    colours = COLOURS[variant]
    angle = np.radians(np.linspace(-90, 90, 25))
    radius = 0.033 * np.cos(angle) ** 0.62 * (1 + 0.06 * np.sin(angle))
    radius *= 0.033 / radius.max()
    z = 0.031 * np.sin(angle)
    dent = np.exp(-((radius / 0.011) ** 2))
    z = z - np.where(z > 0, 0.009, -0.005) * dent
    radius[[0, -1]] = 0
    body = solids.revolved(np.column_stack([radius, z]), 32)
    body.apply_translation((0, 0, -float(body.bounds[0, 2])))
    top = float(body.bounds[1, 2])
    stem_path = np.array(
        [(0, 0, top - 0.012), (0.0004, 0, top - 0.004), (0.0015, 0, top + 0.003), (0.0035, 0, top + 0.008)]
    )
    stem = solids.sweep(stem_path, solids.circle(0.0014, 8), (1, 0.9, 0.9, 1.2), up=(0, 1, 0))
    parts = [
        paint(body, _fruit_skin(rng, *colours, streaks=variant == "red"), around(), roughness=0.35),
        paint(stem, materials.plastic(rng, (92, 62, 36)), tiled(0.05), roughness=0.9),
    ]
    return BuiltObject(parts, [standing(body, 0.014), stem.convex_hull], mass=0.16, friction=0.7)


def _fruit_skin(rng: np.random.Generator, low: Colour, high: Colour, streaks: bool = False) -> np.ndarray:
    """Skin around a fruit: rows from the stem (top) to the bottom, columns around."""
    shape = (256, 256)
    pattern = clouds(rng, shape, (2, 40) if streaks else (4, 4), 3)
    picture = blend(low, high, (pattern - 0.5) * 2.2 + 0.5)
    return over(picture, (250, 236, 190), (noise(rng, shape, (56, 64)) > 0.9) * 0.25)
