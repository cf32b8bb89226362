"""The end of a baguette along x: the right end round, the left one cut."""

from __future__ import annotations

import numpy as np

from assets.textures import foods
from vcage.objects.modelling import pieces, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.noise import blend, clouds, over
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("baguette_piece", variant)
    x = np.concatenate([np.linspace(-0.065, 0.03, 14), 0.03 + 0.035 * np.sin(np.linspace(0.12, 1, 9) * np.pi / 2)])
    round_end = np.sqrt(np.clip(1 - ((x - 0.03) / 0.0352).clip(0) ** 2, 0.004, 1))
    half_width, half_height = 0.026, 0.023
    angle = np.arange(28) * 2 * np.pi / 28
    section = np.stack(
        [np.cos(angle) * half_width, np.maximum(np.sin(angle) * half_height, -0.7 * half_height)], axis=1
    )
    path = np.stack([x, np.zeros_like(x), 0.7 * half_height * round_end], axis=1)
    loaf = solids.displaced(solids.sweep(path, section, round_end), 0.0006, 0.02, rng)
    loaf = solids.above(loaf, 0.0008)
    slice_ = solids.prism(section * 0.95 + (0, 0.7 * half_height), 0.0012)
    slice_ = solids.moved(slice_, (-0.066, 0, 0), turn=120, axis=(1, 1, 1))
    parts = [
        paint(loaf, _baguette_crust(rng, dark=variant == "dark"), around(0, (0.0, 0.016)), roughness=0.8, crease=60),
        paint(slice_, foods.crumb(rng), tiled(0.05), roughness=0.95),
    ]
    return BuiltObject(parts, [*pieces.slabs(loaf, 3), slice_.convex_hull], mass=0.09, friction=0.8)


def _baguette_crust(rng: np.random.Generator, dark: bool = False) -> np.ndarray:
    """A crust around a loaf: rows run along it, columns around with the back in the middle.

    Gold with brown sides, dusted with flour; pale slanting cuts with dark lips across the back.
    """
    shape = (320, 384)
    gold, brown = ((178, 108, 48), (98, 52, 22)) if dark else ((214, 148, 72), (154, 90, 38))
    rows, columns = foods.coordinates(shape)
    around, along = rows * 3.2, columns  # 1 is about 55 degrees from the top
    picture = blend(gold, brown, 0.15 + 0.3 * np.clip(np.abs(around), 0, 2) ** 2 / 2 + 0.6 * (clouds(rng, shape) - 0.5))
    dust = np.clip(clouds(rng, shape, (10, 12)) - 0.45, 0, 1) * np.clip(1.6 - np.abs(around), 0, 1)
    picture = over(picture, (250, 240, 222), dust * 1.3)
    for place in (-0.62, -0.12, 0.38):
        cut = ((along - place - 0.13 * around) / 0.125) ** 2 + (around / 0.95) ** 2
        picture = over(picture, brown, np.clip(1.6 - cut, 0, 1) * 0.85)
        picture = over(
            picture, foods.PALE, np.clip((0.95 - cut) * 3, 0, 1) * (0.75 + 0.25 * clouds(rng, shape, (8, 8)))
        )
    return np.ascontiguousarray(np.rot90(picture))
