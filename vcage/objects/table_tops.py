"""Table tops: 1024 × 1024 pictures for 1.2 m, painted once and kept in the user's cache."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

from vcage.base.errors import UnknownName
from vcage.base.files import cache_dir
from vcage.base.pictures import read_picture, write_picture
from vcage.objects.modelling import materials, noise
from vcage.objects.modelling.noise import blend, clouds, over, shaded

SIZE = 1024


@cache
def table_texture(name: str) -> np.ndarray:
    """A table top (H, W, 3) uint8, always the same for the same name and not to be written to; see :data:`TABLES`.

    Raises:
        UnknownName: no texture has that name.
    """
    if name not in TABLES:
        raise UnknownName("table texture", name, TABLES)
    kept = cache_dir("textures") / f"{name}-{_painters()}.png"
    if not kept.is_file():
        write_picture(kept, TABLES[name](np.random.default_rng(len(name))))
    picture = read_picture(kept)
    picture.flags.writeable = False
    return picture


@cache
def _painters() -> str:
    """Hash of the sources that decide what is painted."""
    sources = [Path(module.__file__ or "").read_bytes() for module in (materials, noise)]
    return hashlib.sha256(b"\0".join([Path(__file__).read_bytes(), *sources])).hexdigest()[:16]


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


TABLES: dict[str, Callable[[np.random.Generator], np.ndarray]] = {
    "grey_stone": _grey_stone,
    "oak": _oak,
    "walnut": _walnut,
    "white_laminate": _white_laminate,
}
"""Name → painter of the table tops."""
