"""Pictures as files hold them: JPEG or PNG, or arrays of pixels, one by one or in datasets of HDF5; read as RGB."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cv2
import h5py
import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile, OversizedFile
from vcage.base.pictures import picture_header, rgb_of_decoded, three_channels

PNG = b"\x89P"
MAGIC = {b"\xff\xd8": "jpeg", PNG: "png"}
"""First bytes of a picture file → its storage."""

COLOURED = 24
"""Least difference of a pixel's largest and smallest channel that counts as a colour, levels."""

CLEARLY = 0.6
"""Share of the coloured pixels of one warmth that decides."""

ENOUGH = 0.01
"""Share of the pixels that must be coloured for them to say anything."""


def storage_of(data: bytes, what: str) -> str:
    """``jpeg`` or ``png``.

    Raises:
        DamagedFile: it is neither.
    """
    found = MAGIC.get(bytes(data[:2]))
    if found is None:
        raise DamagedFile(f"{what} is no JPEG and no PNG", hint="only pictures in these two formats are understood")
    return found


def decode_picture(data: bytes | NDArray[np.uint8], what: str) -> NDArray[np.uint8]:
    """(H, W, 3) uint8 RGB as any reader of picture files shows it; padding behind the file's end is ignored.

    Alpha is laid over white; 16 bits become 8.

    Raises:
        DamagedFile: it is damaged; ``what`` names it.
        OversizedFile: it is too large; see :class:`vcage.base.pictures.PictureLimits`.
    """
    raw = np.frombuffer(data, np.uint8) if isinstance(data, bytes) else np.ascontiguousarray(data, np.uint8)
    # JPEG knows no alpha, and says in its EXIF data how it is to be turned, which IMREAD_UNCHANGED ignores
    picture = _decode(raw, cv2.IMREAD_UNCHANGED if raw[:2].tobytes() == PNG else cv2.IMREAD_COLOR, what)
    return np.asarray(rgb_of_decoded(picture), np.uint8)


def channels_of(data: bytes, what: str) -> int:
    """Channels that a picture file has: 1 grey, 3 RGB, 4 RGBA.

    Raises:
        DamagedFile: it is damaged; ``what`` names it.
    """
    picture = _decode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED, what)
    return 1 if picture.ndim == 2 else picture.shape[2]


def _decode(raw: NDArray[np.uint8], flags: int, what: str) -> NDArray[Any]:
    try:
        picture_header(raw.tobytes(), what)  # which refuses what would not fit in memory
        picture = cv2.imdecode(raw, flags)
    except OversizedFile:
        raise
    except DamagedFile:
        picture = None
    if picture is None:
        raise DamagedFile(f"{what} cannot be decoded", hint="the file is damaged there; leave the episode out")
    return picture


def to_rgb(picture: NDArray[np.uint8], what: str) -> NDArray[np.uint8]:
    """(H, W, 3) of a grey (H, W) or (H, W, 1), RGB or RGBA picture; alpha is laid over white.

    Raises:
        DamagedFile: it is none of these.
    """
    if picture.ndim == 3 and picture.shape[2] == 1:
        picture = picture[..., 0]
    if picture.dtype != np.uint8 or not (picture.ndim == 2 or (picture.ndim == 3 and picture.shape[2] in (3, 4))):
        raise DamagedFile(
            f"{what} is an array {picture.shape} {picture.dtype}", hint="pictures are uint8, grey, RGB or RGBA"
        )
    return three_channels(picture)


def stacked(pictures: Sequence[NDArray[np.uint8]], what: str) -> NDArray[np.uint8]:
    """(N, H, W, 3) of pictures that must be of one size.

    Raises:
        DamagedFile: they are not; names the first that differs.
    """
    for index, picture in enumerate(pictures):
        if picture.shape != pictures[0].shape:
            (h, w), (first_h, first_w) = picture.shape[:2], pictures[0].shape[:2]
            raise DamagedFile(
                f"{what}: picture {index} is {w}x{h}, the first {first_w}x{first_h}",
                hint="a video has one size: resize the pictures, or split the recording where the size changes",
            )
    return np.stack(pictures)


def looks_swapped(pictures: Sequence[NDArray[np.uint8]]) -> bool | None:
    """Whether red and blue changed places in RGB pictures of rooms and tables; None where the colours do not say.

    What is coloured in a room is mostly warm: wood, skin, cardboard, food, lamplight. Swapped, it is blue.
    """
    pixels = np.concatenate([picture.reshape(-1, 3).astype(np.int16) for picture in pictures])
    coloured = pixels[np.ptp(pixels, axis=1) >= COLOURED]
    if len(coloured) < ENOUGH * len(pixels):
        return None
    warm = float((coloured[:, 0] > coloured[:, 2]).mean())
    if max(warm, 1 - warm) < CLEARLY:
        return None
    return warm < 0.5


# --- datasets of HDF5 ----------------------------------------------------------------------------------

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

    Args:
        dataset: of pictures.
        index: of one of them.
        what: names the dataset in messages.

    Raises:
        DamagedFile: it cannot be decoded, or is no picture; ``what`` names the dataset.
    """
    if picture_kind(dataset) == ARRAY:
        return to_rgb(dataset[index], f"{what}[{index}]")
    return decode_picture(encoded_bytes(dataset, index), f"{what}[{index}]")
