"""Pictures of table tops, walls and floors: 1024 × 1024, painted once and kept in the user's cache.

A picture covers a table top once; of walls and floors it covers :data:`SIDE` metres and repeats seamlessly.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

import numpy as np

from vcage.base.errors import UnknownName
from vcage.base.files import cache_dir
from vcage.base.pictures import read_picture, write_picture
from vcage.objects.modelling import materials
from vcage.objects.modelling import noise as noises
from vcage.objects.modelling.noise import Colour, blend, clouds, noise, over, shaded
from vcage.schema.randomisation import Where

SIZE = 1024
SIDE = 2.5
"""Metres that a picture of a wall or floor covers along each side."""

Painter = Callable[[np.random.Generator], np.ndarray]


@cache
def surface_picture(where: Where, name: str) -> np.ndarray:
    """(H, W, 3) uint8 sRGB, always the same for the same name, and not to be written to.

    Args:
        where: kind of surface.
        name: of the picture, see :data:`SURFACES`.

    Raises:
        UnknownName: there is no painter of that name.
    """
    paint = painter_of(where, name)
    cached = cache_dir("textures") / f"{where}-{name}-{_sources_hash()}.png"
    if not cached.is_file():
        write_picture(cached, paint(np.random.default_rng(len(name))))
    picture = read_picture(cached)
    picture.flags.writeable = False
    return picture


def painter_of(where: Where, name: str) -> Painter:
    """The painter of a surface; raises as :func:`surface_picture`."""
    if name not in SURFACES[where]:
        raise UnknownName("table texture" if where == "table" else where, name, SURFACES[where])
    return SURFACES[where][name]


@cache
def _sources_hash() -> str:
    """Hash of the sources that affect the painting."""
    sources = [__file__, str(materials.__file__), str(noises.__file__)]
    return hashlib.sha256(b"\0".join(Path(source).read_bytes() for source in sources)).hexdigest()[:16]


# --- table tops ------------------------------------------------------------------------------------------------


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


# --- walls and floors ----------------------------------------------------------------------------------------


def _rough(rng: np.random.Generator, colour: Colour, depth: float = 0.1) -> np.ndarray:
    """One colour with soft patches."""
    shape = (SIZE, SIZE)
    tone = 1 - depth + 2 * depth * (0.6 * clouds(rng, shape, (8, 8), 5) + 0.2)
    return shaded(np.full((*shape, 3), colour, np.uint8), tone)


def _laid(
    rng: np.random.Generator,
    ground: np.ndarray,
    tiles: tuple[int, int],
    joint: int,
    mortar: Colour,
    shift: bool = False,
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


def _floor_tiles(rng: np.random.Generator) -> np.ndarray:
    """Light and dark ones by turns."""
    y, x = np.indices((SIZE, SIZE)) * 8 // SIZE
    ground = over(_rough(rng, (196, 192, 184), 0.05), (78, 82, 88), ((y + x) % 2) * 0.85)
    return _laid(rng, ground, (8, 8), 4, (150, 148, 144))


def _carpet(rng: np.random.Generator) -> np.ndarray:
    shape = (SIZE, SIZE)
    tone = 0.72 + 0.4 * noise(rng, shape, (400, 400)) + 0.15 * clouds(rng, shape, (6, 6))
    return shaded(np.full((*shape, 3), (104, 62, 66), np.uint8), tone)


SURFACES: Mapping[Where, Mapping[str, Painter]] = {
    "table": {
        "bamboo": _bamboo,
        "beech": lambda rng: materials.wood(rng, materials.BEECH, SIZE, boards=9),
        "green_linoleum": _green_linoleum,
        "grey_stone": _grey_stone,
        "marble": _marble,
        "oak": lambda rng: materials.wood(rng, materials.OAK, SIZE, boards=6),
        "slate": _slate,
        "tablecloth": _tablecloth,
        "walnut": lambda rng: materials.wood(rng, materials.WALNUT, SIZE, boards=5),
        "white_laminate": _white_laminate,
    },
    "wall": {
        "brick": lambda rng: _laid(rng, _rough(rng, (150, 82, 62), 0.2), (32, 10), 4, (178, 170, 158), shift=True),
        "concrete": _concrete,
        "panels": _panels,
        "plaster": lambda rng: _rough(rng, (214, 208, 196), 0.06),
        "stripes": _stripes,
        "wall_tiles": lambda rng: _laid(rng, _rough(rng, (182, 204, 206), 0.03), (16, 16), 3, (228, 228, 224)),
    },
    "floor": {
        "carpet": _carpet,
        "floor_tiles": _floor_tiles,
        "planks": lambda rng: materials.wood(rng, ((118, 76, 44), (176, 128, 82)), SIZE, boards=16),
        "screed": _concrete,
        "terracotta": lambda rng: _laid(rng, _rough(rng, (170, 98, 66), 0.16), (8, 8), 8, (186, 174, 158)),
    },
}
"""Kind of surface → name → painter of an (H, W, 3) uint8 picture."""
