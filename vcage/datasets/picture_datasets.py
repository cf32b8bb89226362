"""HDF5 datasets of pictures: arrays of pixels, or encoded pictures in one of three kinds of dataset."""

from __future__ import annotations

import h5py
import numpy as np
from numpy.typing import NDArray

from vcage.datasets.recordings.encoded import channels_of, decode_picture, storage_of, to_rgb

ARRAY = "array"
"""(T, H, W) or (T, H, W, C) pixels."""

FIXED = "fixed"
"""(T,) strings of one length, padded with NUL."""

PADDED = "padded"
"""(T, N) bytes, padded with 0."""

VLEN = "vlen"
"""(T,) lists of bytes."""


def picture_kind(dataset: h5py.Dataset) -> str:
    """How a dataset holds pictures: :data:`ARRAY`, :data:`FIXED`, :data:`PADDED` or :data:`VLEN`."""
    if dataset.dtype.kind in "SO":
        return FIXED if dataset.dtype.kind == "S" else VLEN
    return PADDED if dataset.dtype == np.uint8 and dataset.ndim == 2 else ARRAY


def picture_storage(dataset: h5py.Dataset, what: str) -> str:
    """``raw``, ``jpeg`` or ``png``, as the first picture is.

    Raises:
        DamagedFile: it is neither; ``what`` names the dataset.
    """
    return "raw" if picture_kind(dataset) == ARRAY else storage_of(encoded_bytes(dataset, 0), f"{what}[0]")


def picture_channels(dataset: h5py.Dataset, what: str) -> int:
    """Channels of the pictures, as the first has them.

    Raises:
        DamagedFile: that is encoded and damaged; ``what`` names the dataset.
    """
    if picture_kind(dataset) == ARRAY:
        return dataset.shape[3] if dataset.ndim == 4 else 1
    return channels_of(encoded_bytes(dataset, 0), f"{what}[0]")


def encoded_bytes(dataset: h5py.Dataset, index: int) -> bytes:
    """The file of an encoded picture, perhaps with padding behind it."""
    value = dataset[index]
    return value if isinstance(value, bytes) else np.asarray(value, np.uint8).tobytes()


def stored_picture(dataset: h5py.Dataset, index: int, what: str) -> NDArray[np.uint8]:
    """(H, W, 3) as stored: encoded pictures as a reader of picture files shows them.

    Raises:
        DamagedFile: it cannot be decoded, or is no picture; ``what`` names the dataset.
    """
    if picture_kind(dataset) == ARRAY:
        return to_rgb(dataset[index], f"{what}[{index}]")
    return decode_picture(encoded_bytes(dataset, index), f"{what}[{index}]")
