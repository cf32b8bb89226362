"""Pictures of surfaces that are painted once and kept in the user's cache."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

import numpy as np

from vcage.base.errors import UnknownName
from vcage.base.files import cache_dir
from vcage.base.pictures import read_picture, write_picture
from vcage.objects.modelling import materials, noise

Painters = Mapping[str, Callable[[np.random.Generator], np.ndarray]]
"""Name → painter of an (H, W, 3) uint8 picture."""


def painted(what: str, name: str, painters: Painters, source: str) -> np.ndarray:
    """(H, W, 3) uint8 sRGB, always the same for the same name, and not to be written to.

    Args:
        what: kind of picture, for an error.
        name: of the picture.
        painters: of this kind.
        source: the file that defines them; another text paints anew.

    Raises:
        UnknownName: there is no painter of that name.
    """
    if name not in painters:
        raise UnknownName(what, name, painters)
    cached = cache_dir("textures") / f"{name}-{_hash_of(source)}.png"
    if not cached.is_file():
        write_picture(cached, painters[name](np.random.default_rng(len(name))))
    picture = read_picture(cached)
    picture.flags.writeable = False
    return picture


@cache
def _hash_of(source: str) -> str:
    """Hash of the sources that decide what is painted."""
    sources = [Path(source), *(Path(module.__file__ or "") for module in (materials, noise))]
    return hashlib.sha256(b"\0".join(path.read_bytes() for path in sources)).hexdigest()[:16]
