"""Lengths and encodings that files state of their pictures, and how they stay true when those change.

ACT++ pads all JPEGs of an episode to one length and keeps how long each was: ``/compress_len``, a row for each camera,
with the attribute ``compress`` of the file. Its readers cut a picture there. Files that were made after its example
have such numbers under other names and the other way round, so they are known by their values.
"""

from __future__ import annotations

import logging
import re
from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass

import h5py
import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import OversizedFile
from vcage.datasets.hdf5_contents import datasets_in
from vcage.datasets.hdf5_limits import require_numbers_fit
from vcage.datasets.stored_pictures import ARRAY, encoded_bytes, picture_kind

logger = logging.getLogger(__name__)

ENCODING_NAMES = ("encoding", "format", "compression", "codec", "image_encoding", "image_format", "img_format")
"""Attributes that say how pictures are encoded, where their text is one of the next."""

JPEG_WORDS = {"jpeg": "png", "jpg": "png", ".jpeg": ".png", ".jpg": ".png", "image/jpeg": "image/png"}

DIGESTS = {"sha1", "sha256", "sha512", "md5", "crc", "crc32", "checksum", "checksums", "hash", "hashes", "digest"}
"""Words in names of checksums."""

FLAG = "compress"
"""ACT++'s attribute of files whose pictures are encoded."""


@dataclass(frozen=True)
class LengthsPlace:
    """Where a file keeps how many bytes each encoded picture of a dataset has.

    Args:
        key: of a dataset of numbers.
        axis: along which the pictures follow each other.
        index: on the other axis; None where there is none.
    """

    key: str
    axis: int
    index: int | None

    def of(self, values: NDArray) -> NDArray:
        """The part of the dataset's values that belongs to the pictures; writing to it changes them."""
        return values if self.index is None else np.take(values, [self.index], 1 - self.axis).reshape(-1)

    def put(self, values: NDArray, lengths: NDArray[np.int64]) -> None:
        """Replace that part."""
        place = [slice(None)] * values.ndim
        if self.index is not None:
            place[1 - self.axis] = self.index  # type: ignore[call-overload]
        values[tuple(place)] = lengths


def picture_lengths(dataset: h5py.Dataset, count: int | None = None) -> NDArray[np.int64]:
    """(T,) bytes of each picture of a dataset, or of the first few, without padding; of arrays, those of the pixels."""
    count = len(dataset) if count is None else count
    if picture_kind(dataset) == ARRAY:
        return np.full(count, int(np.prod(dataset.shape[1:])) * dataset.dtype.itemsize)
    return np.array([len(encoded_bytes(dataset, index).rstrip(b"\0")) for index in range(count)])


def find_lengths(file: h5py.File, keys: Collection[str]) -> dict[str, list[LengthsPlace]]:
    """Key of a dataset of encoded pictures → where the file keeps their lengths; none of those it keeps none of.

    Args:
        file: open.
        keys: of datasets of pictures.
    """
    pictures = {key: file[key] for key in sorted(keys) if picture_kind(file[key]) != ARRAY}
    candidates = _candidates(file, {len(dataset) for dataset in pictures.values()}) if pictures else []
    found: dict[str, list[LengthsPlace]] = {}
    taken: set[LengthsPlace] = set()  # pictures that are alike have rows that are alike
    for key, dataset in pictures.items():
        first = picture_lengths(dataset, 1)[0]
        likely = [numbers for numbers in candidates if (numbers[()] == first).any()]
        lengths = picture_lengths(dataset) if likely else np.zeros(0, int)  # all pictures are read for it
        for numbers in likely:
            places = _places(numbers, lengths)
            free = next((place for place in places if place not in taken), None)
            if free is not None:
                taken.add(free)
                found.setdefault(key, []).append(free)
    return found


def _candidates(file: h5py.File, counts: set[int]) -> list[h5py.Dataset]:
    """Datasets with a number for each picture of one camera or of several; none that is too large for that."""
    found: list[h5py.Dataset] = []
    for dataset in datasets_in(file).values():
        if dataset.dtype.kind not in "iuf" or dataset.dtype == np.uint8:
            continue
        if dataset.ndim in (1, 2) and counts & set(dataset.shape):
            with suppress(OversizedFile):
                require_numbers_fit(dataset)
                found.append(dataset)
    return found


def _places(numbers: h5py.Dataset, lengths: NDArray[np.int64]) -> list[LengthsPlace]:
    values, key = numbers[()], numbers.name.lstrip("/")
    if values.ndim == 1:
        return [LengthsPlace(key, 0, None)] if np.array_equal(values, lengths) else []
    return [
        LengthsPlace(key, axis, index)
        for axis in (1, 0)
        if values.shape[axis] == len(lengths)
        for index in range(values.shape[1 - axis])
        if np.array_equal(np.take(values, index, 1 - axis), lengths)
    ]


def update_lengths(file: h5py.File, places: Mapping[str, Iterable[LengthsPlace]]) -> None:
    """Write the lengths of the pictures that a file holds now where it keeps them.

    Args:
        file: open for writing.
        places: key of a dataset of pictures → where its lengths are.
    """
    for key, own in places.items():
        lengths = picture_lengths(file[key])
        for place in own:
            _put(file, place, lengths)
            logger.info("%s holds the lengths of the new pictures of %s", place.key, key)


def _put(file: h5py.File, place: LengthsPlace, lengths: NDArray[np.int64]) -> None:
    old = file[place.key]
    values = old[()]
    place.put(values, lengths)
    if np.array_equal(place.of(values), lengths):
        old[...] = values
        return
    wide = old[()].astype(np.int64 if old.dtype.kind in "iu" else np.float64)  # PNG is longer than JPEG was
    place.put(wide, lengths)
    attributes = dict(old.attrs)
    del file[place.key]
    file.create_dataset(place.key, data=wide, track_times=False).attrs.update(attributes)


def update_encoding(file: h5py.File, keys: Collection[str], *, raw: bool) -> None:
    """Let the attributes of pictures, and of the groups around them, say how these are encoded now.

    Args:
        file: open for writing.
        keys: of datasets whose pictures were encoded before.
        raw: whether they are arrays of pixels now; PNG otherwise.
    """
    around = {group for key in keys for group in _around(key)}
    for name in around:
        attributes = file[name].attrs
        for attribute in ENCODING_NAMES:
            said = attributes.get(attribute)
            if isinstance(said, str) and said.lower() in JPEG_WORDS:
                attributes[attribute] = "raw" if raw else JPEG_WORDS[said.lower()]
    flag = file.attrs.get(FLAG)
    if raw and isinstance(flag, (np.bool_, np.integer)) and flag and not any(_holds_encoded(file, key) for key in keys):
        file.attrs.modify(FLAG, np.zeros((), np.asarray(flag).dtype))


def _holds_encoded(file: h5py.File, key: str) -> bool:
    """Check for encoded pictures beside a dataset, of cameras that were not put back as arrays."""
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
        for name in _around(key):
            found |= {f"{name}@{attribute}" for attribute in file[name].attrs if _names_digest(attribute)}
        group = key.rpartition("/")[0] or "/"
        found |= {f"{group}/{name}" for name in file[group] if _names_digest(name)}
    return sorted(found)


def _names_digest(name: str) -> bool:
    return not DIGESTS.isdisjoint(re.findall(r"[a-z]+[0-9]*", name.lower()))


def _around(key: str) -> list[str]:
    parts = key.split("/")
    return ["/", *("/".join(parts[: end + 1]) for end in range(len(parts)))]
