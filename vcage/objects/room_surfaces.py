"""Walls and floors: seamless 1024 × 1024 pictures for :data:`SIDE` metres, kept in the user's cache."""

from __future__ import annotations

from functools import cache

import numpy as np

from vcage.objects.modelling import materials
from vcage.objects.modelling.noise import Colour, clouds, noise, over, shaded
from vcage.objects.painting import Painters, painted

SIZE = 1024

SIDE = 2.5
"""Metres that a picture covers along each side."""


@cache
def wall_texture(name: str) -> np.ndarray:
    """A wall (H, W, 3) uint8; see :data:`WALLS`.

    Raises:
        UnknownName: no wall has that name.
    """
    return painted("wall", name, WALLS, __file__)


@cache
def floor_texture(name: str) -> np.ndarray:
    """A floor (H, W, 3) uint8; see :data:`FLOORS`.

    Raises:
        UnknownName: no floor has that name.
    """
    return painted("floor", name, FLOORS, __file__)


def _rough(rng: np.random.Generator, colour: Colour, depth: float = 0.1) -> np.ndarray:
    """One colour with soft patches."""
    shape = (SIZE, SIZE)
    tone = 1 - depth + 2 * depth * (0.6 * clouds(rng, shape, (8, 8), 5) + 0.2)
    return shaded(np.full((*shape, 3), colour, np.uint8), tone)


def _laid(
    rng: np.random.Generator, ground: np.ndarray, tiles: tuple[int, int], joint: int, mortar: Colour, shift: bool
) -> np.ndarray:
    """Cut the ground into bricks or tiles of slightly different tone.

    Args:
        rng: of their tones.
        ground: (H, W, 3) uint8.
        tiles: rows and columns; an even number of rows where they are shifted.
        joint: width of the joints, pixels.
        mortar: colour of the joints.
        shift: shift every second row by half a tile.
    """
    rows, columns = tiles
    y, x = np.indices((SIZE, SIZE))
    row = y * rows // SIZE
    along = (x + (row % 2) * (SIZE // columns // 2 if shift else 0)) % SIZE
    column = along * columns // SIZE
    picture = shaded(ground, rng.uniform(0.84, 1.1, (rows, columns))[row, column])
    at_joint = (y % (SIZE / rows) < joint) | (along % (SIZE / columns) < joint)
    return over(picture, mortar, at_joint * 0.95)


def _plaster(rng: np.random.Generator) -> np.ndarray:
    return _rough(rng, (214, 208, 196), 0.06)


def _brick(rng: np.random.Generator) -> np.ndarray:
    return _laid(rng, _rough(rng, (150, 82, 62), 0.2), (32, 10), 4, (178, 170, 158), shift=True)


def _wall_tiles(rng: np.random.Generator) -> np.ndarray:
    return _laid(rng, _rough(rng, (182, 204, 206), 0.03), (16, 16), 3, (228, 228, 224), shift=False)


def _panels(rng: np.random.Generator) -> np.ndarray:
    """Upright boards of pine."""
    return np.ascontiguousarray(materials.wood(rng, materials.PINE, SIZE, boards=14).transpose(1, 0, 2))


def _stripes(rng: np.random.Generator) -> np.ndarray:
    """Wallpaper with broad stripes."""
    stripe = np.tile((np.arange(SIZE) // 64) % 2 * 0.75, (SIZE, 1))
    return over(_rough(rng, (222, 214, 190), 0.02), (124, 148, 142), stripe)


def _concrete(rng: np.random.Generator) -> np.ndarray:
    picture = _rough(rng, (136, 136, 133), 0.16)
    return over(picture, (84, 84, 84), (noise(rng, (SIZE, SIZE), (220, 220)) > 0.94) * 0.5)


def _planks(rng: np.random.Generator) -> np.ndarray:
    return materials.wood(rng, ((118, 76, 44), (176, 128, 82)), SIZE, boards=16)


def _floor_tiles(rng: np.random.Generator) -> np.ndarray:
    """Light and dark ones by turns."""
    y, x = np.indices((SIZE, SIZE)) * 8 // SIZE
    ground = over(_rough(rng, (196, 192, 184), 0.05), (78, 82, 88), ((y + x) % 2) * 0.85)
    return _laid(rng, ground, (8, 8), 4, (150, 148, 144), shift=False)


def _carpet(rng: np.random.Generator) -> np.ndarray:
    shape = (SIZE, SIZE)
    tone = 0.72 + 0.4 * noise(rng, shape, (400, 400)) + 0.15 * clouds(rng, shape, (6, 6))
    return shaded(np.full((*shape, 3), (104, 62, 66), np.uint8), tone)


def _terracotta(rng: np.random.Generator) -> np.ndarray:
    return _laid(rng, _rough(rng, (170, 98, 66), 0.16), (8, 8), 8, (186, 174, 158), shift=False)


WALLS: Painters = {
    "brick": _brick,
    "concrete": _concrete,
    "panels": _panels,
    "plaster": _plaster,
    "stripes": _stripes,
    "wall_tiles": _wall_tiles,
}
"""Name → painter of the walls."""

FLOORS: Painters = {
    "carpet": _carpet,
    "floor_tiles": _floor_tiles,
    "planks": _planks,
    "screed": _concrete,
    "terracotta": _terracotta,
}
"""Name → painter of the floors."""
