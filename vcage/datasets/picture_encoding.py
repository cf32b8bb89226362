"""How files say that their pictures are encoded, and how it stays true when the pictures change."""

from __future__ import annotations

from collections.abc import Collection, Iterable

import h5py
import numpy as np

from vcage.datasets.picture_lengths import around, words_of
from vcage.datasets.stored_pictures import ARRAY, picture_kind

ENCODING_NAMES = ("encoding", "format", "compression", "codec", "image_encoding", "image_format", "img_format")
"""Attributes that say how pictures are encoded, where their text is one of the next."""

JPEG_WORDS = {"jpeg": "png", "jpg": "png", ".jpeg": ".png", ".jpg": ".png", "image/jpeg": "image/png"}

DIGESTS = {"sha1", "sha256", "sha512", "md5", "crc", "crc32", "checksum", "checksums", "hash", "hashes", "digest"}
"""Words in names of checksums."""

FLAG = "compress"
"""ACT++'s attribute of files whose pictures are encoded."""


def update_encoding(file: h5py.File, keys: Collection[str], *, raw: bool) -> None:
    """Let the attributes of pictures, and of the groups around them, say how these are encoded now.

    Args:
        file: open for writing.
        keys: of datasets whose pictures were encoded before.
        raw: whether they are arrays of pixels now; PNG otherwise.
    """
    for name in {group for key in keys for group in around(key)}:
        attributes = file[name].attrs
        for attribute in ENCODING_NAMES:
            said = attributes.get(attribute)
            if isinstance(said, str) and said.lower() in JPEG_WORDS:
                attributes[attribute] = "raw" if raw else JPEG_WORDS[said.lower()]
    flag = file.attrs.get(FLAG)
    if raw and isinstance(flag, (np.bool_, np.integer)) and flag and not any(_holds_encoded(file, key) for key in keys):
        file.attrs.modify(FLAG, np.zeros((), np.asarray(flag).dtype))


def _holds_encoded(file: h5py.File, key: str) -> bool:
    """Check for encoded pictures beside a dataset: those of cameras that were not put back as arrays."""
    beside = (item for item in file[key].parent.values() if isinstance(item, h5py.Dataset) and item.shape)
    return any(picture_kind(item) != ARRAY for item in beside)


def digests_beside(file: h5py.File, keys: Iterable[str]) -> list[str]:
    """Checksums of pictures, as their names say: attributes of the pictures and of the groups around them, and
    datasets beside them. They hold for the pictures as they are, and for none that was encoded again.

    Args:
        file: open.
        keys: of datasets of pictures.
    """
    found = set()
    for key in keys:
        for name in around(key):
            found |= {f"{name}@{attribute}" for attribute in file[name].attrs if _names_digest(attribute)}
        group = key.rpartition("/")[0] or "/"
        found |= {f"{group}/{name}" for name in file[group] if _names_digest(name)}
    return sorted(found)


def _names_digest(name: str) -> bool:
    return not DIGESTS.isdisjoint(words_of(name))
