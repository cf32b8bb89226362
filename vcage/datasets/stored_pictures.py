"""Stored pictures, encoded or arrays of pixels, in files or in datasets of HDF5; read as 8-bit RGB."""

from __future__ import annotations

import io
import math
import struct
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any, BinaryIO, Literal

import cv2
import deflate
import h5py
import numpy as np
from numpy.typing import NDArray
from PIL.TiffImagePlugin import BITSPERSAMPLE, TiffImageFile

from vcage.base.errors import DamagedFile, OversizedFile
from vcage.base.pictures import picture_header, rgb_of_decoded, three_channels

MAGIC = (
    (b"\xff\xd8", 0, "jpeg"),
    (b"\x89P", 0, "png"),
    (b"WEBP", 8, "webp"),
    (b"BM", 0, "bmp"),
    (b"II*\0", 0, "tiff"),
    (b"MM\0*", 0, "tiff"),
)
"""Bytes of a picture file, where they stand in it, and its storage."""

ENCODED = ("jpeg", "png", "webp", "bmp", "tiff")
"""Storages that are picture files."""

WITH_ALPHA = ("png", "webp", "tiff")
"""Storages whose fourth channel is alpha. In a bitmap it is filling. JPEG has none, and OpenCV ignores its EXIF
orientation if a picture is read unchanged."""

UNREADABLE = (OSError, EOFError, ValueError, KeyError, TypeError, SyntaxError, struct.error)
"""Errors of Pillow on the head of a damaged file."""

PNG_HEAD = 26
"""Bytes at the start of a PNG file; the last but one states the bits a channel."""


def storage_of(data: bytes, what: str) -> str:
    """Return one of :data:`ENCODED`.

    Raises:
        DamagedFile: it is not such a file; ``what`` names it.
    """
    for magic, place, storage in MAGIC:
        if bytes(data[place : place + len(magic)]) == magic:
            return storage
    raise DamagedFile(
        f"{what} is not a known kind of picture file", hint=f"pictures are read from {', '.join(ENCODED)}; convert it"
    )


def sixteen_bits(data: bytes) -> bool:
    """True for a picture file with more than 8 bits a channel, as depth has; it is not decoded."""
    try:
        return picture_bits(io.BytesIO(data)) > 8
    except UNREADABLE:  # the error comes where it is decoded
        return False


def picture_bits(file: BinaryIO) -> int:
    """Return bits a channel of a PNG or TIFF file, without decoding it; 0 of another file.

    Raises:
        UNREADABLE: its head is damaged.
    """
    head = file.read(PNG_HEAD)
    if head[:2] == b"\x89P":
        return head[PNG_HEAD - 2] if len(head) == PNG_HEAD else 0
    if head[:4] not in (b"II*\0", b"MM\0*"):
        return 0
    file.seek(0)
    return max(TiffImageFile(file).tag_v2.get(BITSPERSAMPLE, (1,)))


def decode_picture(data: bytes | NDArray[np.uint8], what: str) -> NDArray[np.uint8]:
    """Return (H, W, 3) uint8 RGB as any reader of picture files shows it; padding behind the file's end is ignored.

    Alpha is laid over white.

    Raises:
        DamagedFile: it is damaged, or has more than 8 bits a channel; ``what`` names it.
        OversizedFile: it is too large; see :class:`vcage.base.pictures.PictureLimits`.
    """
    raw = np.frombuffer(data, np.uint8) if isinstance(data, bytes) else np.ascontiguousarray(data, np.uint8)
    picture = _decode(raw, what)
    if picture.dtype != np.uint8:
        raise DamagedFile(
            f"{what} is {picture.dtype}, which 8-bit pictures cannot hold",
            hint="put depth into a folder or a dataset of its own; it stays unchanged",
        )
    return np.asarray(rgb_of_decoded(picture), np.uint8)


def channels_of(data: bytes, what: str) -> int:
    """Return channels of a picture file: 1 grey, 3 RGB, 4 RGBA.

    Raises:
        DamagedFile: it is damaged; ``what`` names it.
    """
    picture = _decode(np.frombuffer(data, np.uint8), what, cv2.IMREAD_UNCHANGED)
    if picture.ndim == 2:
        return 1
    return picture.shape[2] if storage_of(data, what) in WITH_ALPHA else 3


def _decode(raw: NDArray[np.uint8], what: str, flags: int | None = None) -> NDArray[Any]:
    """Return channels as in the file where it may have alpha, else BGR."""
    if flags is None:
        keeps = len(raw) and storage_of(raw[:16].tobytes(), what) in WITH_ALPHA
        flags = cv2.IMREAD_UNCHANGED if keeps else cv2.IMREAD_COLOR
    try:
        picture_header(raw.tobytes(), what)  # refuses pictures that do not fit in memory
        picture = cv2.imdecode(raw, flags)
    except OversizedFile:
        raise
    except DamagedFile:
        picture = None
    if picture is None:
        raise DamagedFile(f"{what} cannot be decoded", hint="the file is damaged there; leave the episode out")
    return picture


def to_rgb(picture: NDArray[np.uint8], what: str) -> NDArray[np.uint8]:
    """Return (H, W, 3) of a grey (H, W) or (H, W, 1), RGB or RGBA picture; alpha is laid over white.

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
    """Return (N, H, W, 3) of pictures that must be of one size.

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


# --- datasets of HDF5 ----------------------------------------------------------------------------------

PictureKind = Literal["array", "fixed", "padded", "vlen"]

ARRAY: PictureKind = "array"
"""(T, H, W) or (T, H, W, C) pixels."""

FIXED: PictureKind = "fixed"
"""(T,) strings of one length, padded with NUL."""

PADDED: PictureKind = "padded"
"""(T, N) bytes, padded with 0."""

VLEN: PictureKind = "vlen"
"""(T,) lists of bytes."""


def picture_kind(dataset: h5py.Dataset) -> PictureKind:
    """Return how a dataset holds pictures: :data:`ARRAY`, :data:`FIXED`, :data:`PADDED` or :data:`VLEN`."""
    if dataset.dtype.kind in "SO":
        return FIXED if dataset.dtype.kind == "S" else VLEN
    return PADDED if dataset.dtype == np.uint8 and dataset.ndim == 2 else ARRAY


def picture_storage(dataset: h5py.Dataset, what: str) -> str:
    """Return ``raw``, or one of :data:`ENCODED`, by the first picture.

    Raises:
        DamagedFile: it is neither; ``what`` names the dataset.
    """
    return "raw" if picture_kind(dataset) == ARRAY else storage_of(encoded_bytes(dataset, 0), f"{what}[0]")


def picture_channels(dataset: h5py.Dataset, what: str) -> int:
    """Return channels of the first picture.

    Raises:
        DamagedFile: the encoded file is damaged; ``what`` names the dataset.
    """
    if picture_kind(dataset) == ARRAY:
        return dataset.shape[3] if dataset.ndim == 4 else 1
    return channels_of(encoded_bytes(dataset, 0), f"{what}[0]")


def encoded_bytes(dataset: h5py.Dataset, index: int) -> bytes:
    """Return the file of an encoded picture, perhaps with padding behind it."""
    value = dataset[index]
    return value if isinstance(value, bytes) else np.asarray(value, np.uint8).tobytes()


def stored_picture(dataset: h5py.Dataset, index: int, what: str) -> NDArray[np.uint8]:
    """Return (H, W, 3) as stored: encoded pictures as a reader of picture files shows them.

    Args:
        dataset: of pictures.
        index: of one of them.
        what: names the dataset in messages.

    Raises:
        DamagedFile: it cannot be decoded, or is no picture; ``what`` names the dataset.
    """
    if picture_kind(dataset) == ARRAY:
        alone = _inflated(dataset, index)
        return to_rgb(dataset[index] if alone is None else alone, f"{what}[{index}]")
    return decode_picture(encoded_bytes(dataset, index), f"{what}[{index}]")


def _inflated(dataset: h5py.Dataset, index: int) -> NDArray[np.uint8] | None:
    """Return a picture that is a deflated chunk of its own, with libdeflate in a fifth of HDF5's time; None for others.

    None also where that fails: HDF5 knows what is wrong, or what a chunk holds that was never written.
    """
    size = dataset.shape[1:]
    if dataset.compression != "gzip" or dataset.chunks != (1, *size) or dataset.dtype != np.uint8:
        return None
    if dataset.id.get_create_plist().get_nfilters() > 1:
        return None
    with suppress(RuntimeError, OSError, ValueError, deflate.DeflateError):
        skipped, packed = dataset.id.read_direct_chunk((index, *(0 for _ in size)))
        if not skipped:
            return np.frombuffer(deflate.zlib_decompress(packed, math.prod(size)), np.uint8).reshape(size)
    return None


# --- picture files of unknown lengths, one after the other ---


class Spool:
    """Pieces in a file, in order.

    Args:
        file: open for reading and writing, empty.
        pieces: taken one at a time.

    Attributes:
        sizes: length of each piece, bytes.
    """

    def __init__(self, file: IO[bytes], pieces: Iterable[bytes]):
        self._file = file
        self.sizes = [file.write(piece) for piece in pieces]

    @property
    def longest(self) -> int:
        """Length of the longest piece, bytes."""
        return max(self.sizes)

    def __len__(self) -> int:
        return len(self.sizes)

    def __iter__(self) -> Iterator[bytes]:
        self._file.seek(0)
        for size in self.sizes:
            yield self._file.read(size)


@contextmanager
def spooled(pieces: Iterable[bytes], folder: Path) -> Iterator[Spool]:
    """Write ``pieces`` into an unnamed file in ``folder``, which disappears afterwards."""
    with tempfile.TemporaryFile(dir=folder) as file:
        yield Spool(file, pieces)
