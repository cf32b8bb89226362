"""Table tops: 1024 × 1024 pictures for 1.2 m."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from vcage.assets.textures import materials
from vcage.assets.textures.noise import blend, clouds, noise, over, shaded
from vcage.errors import UnknownName

SIZE = 1024


def table_texture(name: str) -> np.ndarray:
    """A table top (H, W, 3) uint8, always the same for the same name; see :data:`TABLES`.

    Raises:
        UnknownName: no texture has that name.
    """
    if name not in TABLES:
        raise UnknownName("table texture", name, TABLES)
    return TABLES[name](np.random.default_rng(len(name)))


def _oak(rng: np.random.Generator) -> np.ndarray:
    return materials.wood(rng, materials.OAK, SIZE, boards=6)


def _walnut(rng: np.random.Generator) -> np.ndarray:
    return materials.wood(rng, materials.WALNUT, SIZE, boards=5)


def _white_laminate(rng: np.random.Generator) -> np.ndarray:
    return shaded(
        np.full((SIZE, SIZE, 3), (232, 231, 227), dtype=np.uint8), 0.975 + 0.03 * clouds(rng, (SIZE, SIZE), (24, 24))
    )


def _grey_stone(rng: np.random.Generator) -> np.ndarray:
    shape = (SIZE, SIZE)
    picture = blend((104, 106, 108), (168, 168, 166), clouds(rng, shape, (6, 6), 6) * 1.6 - 0.3)
    veins = np.abs(clouds(rng, shape, (3, 3), 5) - 0.5)
    picture = over(picture, (206, 206, 204), np.clip(1 - veins * 45, 0, 1) * 0.35)
    return over(picture, (70, 72, 74), (noise(rng, shape, (300, 300)) > 0.93) * 0.4)


TABLES: dict[str, Callable[[np.random.Generator], np.ndarray]] = {
    "grey_stone": _grey_stone,
    "oak": _oak,
    "walnut": _walnut,
    "white_laminate": _white_laminate,
}
"""Name → painter of the table tops."""
