"""Table tops: 1024 × 1024 pictures for 1.2 m, painted once and kept in the user's cache."""

from __future__ import annotations

from functools import cache

import numpy as np

from vcage.objects.modelling import materials
from vcage.objects.modelling.noise import blend, clouds, noise, over, shaded
from vcage.objects.painting import Painters, painted

SIZE = 1024


@cache
def table_texture(name: str) -> np.ndarray:
    """A table top (H, W, 3) uint8, always the same for the same name and not to be written to; see :data:`TABLES`.

    Raises:
        UnknownName: no texture has that name.
    """
    return painted("table texture", name, TABLES, __file__)


def _oak(rng: np.random.Generator) -> np.ndarray:
    return materials.wood(rng, materials.OAK, SIZE, boards=6)


def _walnut(rng: np.random.Generator) -> np.ndarray:
    return materials.wood(rng, materials.WALNUT, SIZE, boards=5)


def _white_laminate(rng: np.random.Generator) -> np.ndarray:
    return shaded(
        np.full((SIZE, SIZE, 3), (232, 231, 227), dtype=np.uint8), 0.975 + 0.03 * clouds(rng, (SIZE, SIZE), (24, 24))
    )


def _grey_stone(rng: np.random.Generator) -> np.ndarray:
    """Fine granite: a calm ground with dark and light grains."""
    shape = (SIZE, SIZE)
    picture = blend((132, 133, 135), (152, 152, 150), clouds(rng, shape, (5, 5), 4))
    for colour, share in (((84, 86, 90), 0.10), ((186, 186, 182), 0.10), ((112, 113, 116), 0.25)):
        grains = clouds(rng, shape, (260, 260), 2)
        picture = over(picture, colour, (grains > np.quantile(grains, 1 - share)) * 0.3)
    return picture


def _beech(rng: np.random.Generator) -> np.ndarray:
    return materials.wood(rng, materials.BEECH, SIZE, boards=9)


def _bamboo(rng: np.random.Generator) -> np.ndarray:
    """Narrow strips with the knots of the cane."""
    picture = materials.wood(rng, ((196, 164, 96), (224, 196, 134)), SIZE, boards=24)
    strip, rows = np.arange(24), np.arange(SIZE) * 24 // SIZE
    knots = rng.uniform(0, SIZE, (24, 4))[strip]
    away = np.abs(np.arange(SIZE)[None, :, None] - knots[rows][:, None]).min(axis=2)
    return over(picture, (140, 104, 52), np.exp(-((away / 3.0) ** 2)) * 0.5)


def _slate(rng: np.random.Generator) -> np.ndarray:
    shape = (SIZE, SIZE)
    picture = blend((52, 57, 62), (82, 87, 91), clouds(rng, shape, (14, 5), 5))
    return over(picture, (104, 108, 110), np.clip((noise(rng, shape, (180, 24)) - 0.8) * 3, 0, 0.4))


def _marble(rng: np.random.Generator) -> np.ndarray:
    """White with grey veins, where warped noise crosses its middle."""
    shape = (SIZE, SIZE)
    picture = blend((214, 213, 210), (240, 239, 236), clouds(rng, shape, (3, 3)))
    for width, strength in ((0.012, 0.55), (0.03, 0.3)):
        away = np.abs(clouds(rng, shape, (3, 4)) - 0.5)
        picture = over(picture, (128, 130, 136), np.exp(-((away / width) ** 2)) * strength)
    return picture


def _tablecloth(rng: np.random.Generator) -> np.ndarray:
    """Linen with blue checks, a check of 7.5 cm."""
    stripe = (np.arange(SIZE) // 32) % 2 * 0.42
    woven = shaded(
        np.full((SIZE, SIZE, 3), (236, 234, 226), np.uint8), 0.94 + 0.06 * noise(rng, (SIZE, SIZE), (256, 256))
    )
    return over(over(woven, (66, 98, 150), np.tile(stripe, (SIZE, 1))), (66, 98, 150), np.tile(stripe[:, None], SIZE))


def _green_linoleum(rng: np.random.Generator) -> np.ndarray:
    shape = (SIZE, SIZE)
    picture = blend((84, 112, 92), (104, 132, 110), clouds(rng, shape, (20, 20), 4))
    return over(picture, (150, 168, 148), (noise(rng, shape, (200, 200)) > 0.93) * 0.3)


TABLES: Painters = {
    "bamboo": _bamboo,
    "beech": _beech,
    "green_linoleum": _green_linoleum,
    "grey_stone": _grey_stone,
    "marble": _marble,
    "oak": _oak,
    "slate": _slate,
    "tablecloth": _tablecloth,
    "walnut": _walnut,
    "white_laminate": _white_laminate,
}
"""Name → painter of the table tops."""
