"""Statements of files on the encoding of their pictures, updated when the pictures change."""

from __future__ import annotations

from collections.abc import Collection, Iterable

import h5py
import numpy as np

from vcage.datasets.picture_lengths import around, words_of
from vcage.datasets.stored_pictures import ARRAY, picture_kind

ENCODING_NAMES = ("encoding", "format", "compression", "codec", "image_encoding", "image_format", "img_format")
"""Attributes that state an encoding, where their text is one of :data:`JPEG_WORDS`."""

JPEG_WORDS = {"jpeg": "png", "jpg": "png", ".jpeg": ".png", ".jpg": ".png", "image/jpeg": "image/png"}

DIGESTS = {"sha1", "sha256", "sha512", "md5", "crc", "crc32", "checksum", "checksums", "hash", "hashes", "digest"}
"""Words in names of checksums."""

FLAG = "compress"
"""ACT++'s attribute of files whose pictures are encoded."""


def update_encoding(file: h5py.File, keys: Collection[str], *, raw: bool) -> None:
    """Update the encoding in the attributes of pictures and of the groups around them.

    Args:
        file: open for writing.
        keys: of datasets whose pictures were encoded before.
        raw: true if they are arrays of pixels now; PNG otherwise.
    """
    for name in {group for key in keys for group in around(key)}:
        attributes = file[name].attrs
        for attribute in ENCODING_NAMES:
            stated = attributes.get(attribute)
            word = JPEG_WORDS.get(stated.lower()) if isinstance(stated, str) else None
            if word is not None:
                attributes[attribute] = "raw" if raw else word
    flag = file.attrs.get(FLAG)
    if raw and isinstance(flag, (np.bool_, np.integer)) and flag and not _encoded_beside(file, keys):
        file.attrs.modify(FLAG, np.zeros((), np.asarray(flag).dtype))


def _encoded_beside(file: h5py.File, keys: Collection[str]) -> bool:
    """True if encoded pictures of other cameras lie beside one of these datasets."""
    beside = [item for key in keys for item in file[key].parent.values() if isinstance(item, h5py.Dataset)]
    return any(item.shape and picture_kind(item) != ARRAY for item in beside)


def digests_beside(file: h5py.File, keys: Iterable[str]) -> list[str]:
    """Return names of checksums of pictures: attributes of the pictures and of the groups around them, and datasets.

    They hold for the unchanged pictures, and for none encoded again.

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
