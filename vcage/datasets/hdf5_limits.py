"""Limits on the size of HDF5 files of others, checked before anything is read."""

from __future__ import annotations

from dataclasses import dataclass

import h5py
import numpy as np
from h5py import h5z

from vcage.base.errors import DamagedFile, OversizedFile


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
