"""Contents of HDF5 files of others: groups, links and datasets, read within limits."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

import h5py
import numpy as np
from h5py import h5o, h5r, h5z  # pyrefly: ignore[missing-module-attribute]  the stubs lack h5o

from vcage.base.errors import DamagedFile, OversizedFile
from vcage.base.folders import natural_key


@dataclass(frozen=True)
class Hdf5Limits:
    """Limits on a file.

    Args:
        max_number_bytes: of a dataset of numbers, which is read whole.
        max_chunk_bytes: of a chunk as it is in memory; one is unpacked to read any part of it.
        max_picture_bytes: of one picture, encoded or as an array; 50 megapixels with 8 bytes each.
        max_frames: of a recording; 92 hours at 30 frames per second.
        max_links: names in the groups of a file.
        max_depth: groups in one another.
    """

    max_number_bytes: int = 2**29
    max_chunk_bytes: int = 2**30
    max_picture_bytes: int = 400_000_000
    max_frames: int = 10_000_000
    max_links: int = 1_000_000
    max_depth: int = 64


LIMITS = Hdf5Limits()

FILTERS = {32001: "Blosc", 32004: "LZ4", 32008: "Bitshuffle", 32015: "Zstandard", 32026: "Blosc2"}
"""Filters that are common and not part of HDF5, by number."""


def require_readable(dataset: h5py.Dataset, limits: Hdf5Limits = LIMITS) -> None:
    """Require that a part of a dataset can be read: its filters are known, and a chunk of it fits in memory.

    Raises:
        DamagedFile: a filter is missing.
        OversizedFile: its chunks are too large.
    """
    if dataset.chunks is not None:
        size = int(np.prod(dataset.chunks, dtype=object)) * dataset.dtype.itemsize
        _require_at_most(dataset, size, limits.max_chunk_bytes, "a chunk of it has", "bytes")
    properties = dataset.id.get_create_plist()
    for index in range(properties.get_nfilters()):
        number, _, _, name = properties.get_filter(index)
        if not h5z.filter_avail(number):
            named = FILTERS.get(number) or name.decode(errors="replace") or "unknown"
            raise DamagedFile(
                f"{_named(dataset)} is compressed by the filter {number} ({named}), which HDF5 does not have here",
                hint="repack it with gzip: h5repack -f GZIP=1 IN OUT, where the filter is installed",
            )


def require_numbers_fit(dataset: h5py.Dataset, limits: Hdf5Limits = LIMITS) -> None:
    """Require that a dataset can be read whole.

    Raises:
        DamagedFile, OversizedFile: see :func:`require_readable`; or it declares too many numbers.
    """
    require_readable(dataset, limits)
    size = int(np.prod(dataset.shape, dtype=object)) * dataset.dtype.itemsize if dataset.shape else 0
    _require_at_most(dataset, size, limits.max_number_bytes, f"it declares {dataset.shape},", "bytes")


def require_pictures_fit(dataset: h5py.Dataset, limits: Hdf5Limits = LIMITS) -> None:
    """Require that any picture of a dataset can be read; encoded ones are checked when they are decoded.

    Raises:
        DamagedFile, OversizedFile: see :func:`require_readable`; or it declares too many, or too large ones.
    """
    if not dataset.shape:
        return
    require_readable(dataset, limits)
    _require_at_most(dataset, dataset.shape[0], limits.max_frames, "it declares", "pictures")
    size = int(np.prod(dataset.shape[1:], dtype=object)) * dataset.dtype.itemsize
    _require_at_most(dataset, size, limits.max_picture_bytes, f"it declares {dataset.shape}, a picture has", "bytes")


def _require_at_most(dataset: h5py.Dataset, found: int, most: int, what: str, unit: str) -> None:
    if found > most:
        raise OversizedFile(
            f"{_named(dataset)} is too large: {what} {found:,} {unit}; at most {most:,} are read",
            hint="split the recording, or leave it out",
            details={"path": dataset.file.filename, "dataset": dataset.name, "found": found, "most": most},
        )


def _named(dataset: h5py.Dataset) -> str:
    return f"{dataset.file.filename}:{dataset.name}"


def address(one: h5py.HLObject) -> int:
    """Return the identity of an object in a file, under any name."""
    return int(h5o.get_info(one.id).addr)


def encoded_name(owner: h5py.HLObject, name: str | bytes) -> bytes:
    """Return a name in a group, or of an attribute, encoded for HDF5.

    Raises:
        DamagedFile: it is not UTF-8, and so cannot be written into records.
    """
    try:
        if isinstance(name, str):  # bytes are what h5py cannot decode
            return name.encode()
    except UnicodeEncodeError:
        pass
    raise DamagedFile(
        f"{owner.file.filename}:{owner.name} holds the name {name!r}, which is not UTF-8",
        hint="rename it, or leave the file out",
    )


def require_utf8_text(owner: h5py.HLObject, name: str, value: object) -> None:
    """Raise DamagedFile where an attribute is text that is not UTF-8; other values pass."""
    try:
        if isinstance(value, str):
            value.encode()
    except UnicodeEncodeError as error:
        raise DamagedFile(
            f"{owner.file.filename}:{owner.name}: the attribute {name} is not UTF-8", hint="write it again as UTF-8"
        ) from error


def walk(part: h5py.Group, limits: Hdf5Limits = LIMITS) -> Iterator[tuple[str, h5py.HLObject]]:
    """Yield all objects of a group, under every name, soft links followed, in natural order.

    Args:
        part: a group of a file that :func:`require_own_contents` checked.
        limits: on the number of names.

    Yields:
        Path from ``part`` on, and the object.

    Raises:
        OversizedFile: it has too many names.
    """
    waiting = [("", part, frozenset({address(part)}))]
    count = 0
    while waiting:
        prefix, group, around = waiting.pop()
        deeper = []
        for name in sorted(group, key=natural_key):
            count += 1
            if count > limits.max_links:
                raise OversizedFile(
                    f"{part.file.filename}:{part.name} has more than {limits.max_links:,} names, soft links followed",
                    hint="delete links, or leave the file out",
                )
            one = group[name]
            yield f"{prefix}{name}", one
            if isinstance(one, h5py.Group) and (place := address(one)) not in around:
                deeper.append((f"{prefix}{name}/", one, around | {place}))
        waiting += reversed(deeper)


def datasets_in(part: h5py.Group, pattern: str = ".*") -> dict[str, h5py.Dataset]:
    """Return the datasets below a group with matching paths from there, in natural order of the paths, each once.

    A dataset with several such names is listed under one, without a soft link in it if possible.

    Args:
        part: a group.
        pattern: of the whole path.
    """
    found: dict[int, tuple[bool, str, h5py.Dataset]] = {}
    for key, one in walk(part):
        if isinstance(one, h5py.Dataset) and re.fullmatch(pattern, key):
            place, soft = address(one), _by_soft_link(part, key)
            if place not in found or (found[place][0] and not soft):
                found[place] = soft, key, one.file[h5r.get_name(one.ref, one.id)] if soft else one
    return {key: one for _, key, one in sorted(found.values(), key=lambda entry: natural_key(entry[1]))}


def _by_soft_link(part: h5py.Group, key: str) -> bool:
    names = key.split("/")
    paths = ("/".join(names[: end + 1]) for end in range(len(names)))
    return any(isinstance(part.get(path, getlink=True), h5py.SoftLink) for path in paths)
