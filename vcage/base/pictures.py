"""Picture files: written as PNG, read from any common format once their header declares a size that fits in memory.

Every picture that a user or a model hands over is opened here, so none is decoded before its size is known.
"""

from __future__ import annotations

import contextlib
import io
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from PIL import (
    BmpImagePlugin,
    GifImagePlugin,
    Image,
    ImageFile,
    ImageOps,
    JpegImagePlugin,
    PngImagePlugin,
    TiffImagePlugin,
    WebPImagePlugin,
)

from vcage.base.errors import DamagedFile, OversizedFile, VcageError
from vcage.base.files import stage_of_file, write_bytes
from vcage.base.reading import open_regular


@dataclass(frozen=True)
class PictureLimits:
    """The largest picture that is decoded.

    Args:
        max_pixels: width times height; models draw up to 4096 x 4096, cameras take up to 50 megapixels.
        max_edge_px: OpenCV warps no picture with an edge above 32,766.
        max_file_bytes: the most that ``max_pixels`` take without compression, with 16 bits in each of 4 channels.
    """

    max_pixels: int = 50_000_000
    max_edge_px: int = 16_384
    max_file_bytes: int = 400_000_000


LIMITS = PictureLimits()

_TIFF = ("TIFF", TiffImagePlugin.TiffImageFile)
_READERS: dict[bytes, tuple[str, type[ImageFile.ImageFile]]] = {
    b"\x89PNG\r\n\x1a\n": ("PNG", PngImagePlugin.PngImageFile),
    b"\xff\xd8\xff": ("JPEG", JpegImagePlugin.JpegImageFile),
    b"RIFF": ("WebP", WebPImagePlugin.WebPImageFile),
    b"BM": ("BMP", BmpImagePlugin.BmpImageFile),
    b"GIF8": ("GIF", GifImagePlugin.GifImageFile),
    b"II*\0": _TIFF,
    b"MM\0*": _TIFF,
    b"II+\0": _TIFF,
    b"MM\0+": _TIFF,
}
"""First bytes of a file → its format and Pillow's reader, which decodes no pixel before it is asked to."""

FORMATS = tuple(dict.fromkeys(name for name, _ in _READERS.values()))
"""Formats that are read."""


@dataclass(frozen=True)
class PictureHeader:
    """Format and size in the header of a picture file.

    Args:
        format: one of :data:`FORMATS`.
        width, height: pixels, as stored.
    """

    format: str
    width: int
    height: int


def write_picture(path: Path, picture: np.ndarray) -> Path:
    """Write a (H, W, 3) uint8 RGB picture as PNG."""
    return write_bytes(path, cv2.imencode(".png", cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))[1].tobytes())


def jpeg(picture: np.ndarray, quality: int) -> bytes:
    """A (H, W, 3) uint8 RGB picture as a JPEG file of that quality, 0 to 100."""
    bgr = cv2.cvtColor(picture, cv2.COLOR_RGB2BGR)
    return cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()


def write_labels(path: Path, labels: np.ndarray) -> Path:
    """Write a (H, W) label image as 16-bit PNG."""
    return write_bytes(path, cv2.imencode(".png", labels.astype(np.uint16))[1].tobytes())


def picture_header(source: Path | bytes, name: str = "", limits: PictureLimits = LIMITS) -> PictureHeader:
    """Format and size of a picture, by its header; no pixel is decoded.

    Args:
        source: a file, or its content.
        name: names it in errors; by default the path.
        limits: larger files are refused.

    Raises:
        MissingStage: the file is not there.
        DamagedFile: it is not one still picture of a format that is read.
        OversizedFile: it is larger than the limits.
    """
    with _opened(source, name, limits) as (image, kind):
        return PictureHeader(kind, *image.size)


def read_picture(source: Path | bytes, name: str = "", limits: PictureLimits = LIMITS) -> np.ndarray:
    """A picture as (H, W, 3) uint8 RGB; grey becomes RGB, alpha is laid over white, EXIF's turn is made.

    Args:
        source, name, limits: as for :func:`picture_header`.

    Raises:
        MissingStage, DamagedFile, OversizedFile: as :func:`picture_header`.
    """
    with _opened(source, name, limits) as (image, _):
        return three_channels(_channels(ImageOps.exif_transpose(image)))


def read_labels(path: Path) -> np.ndarray:
    """Read a label image as (H, W) int32; raises as :func:`read_picture`."""
    with _opened(path, "", LIMITS) as (image, _):
        if image.mode != "L" and not _holds_words(image):
            raise DamagedFile(f"{path} is a colour picture, not a label image", maker="select_place")
        return np.asarray(image).astype(np.int32)


def _channels(image: Image.Image) -> np.ndarray:
    """(H, W) or (H, W, 3 or 4) uint8 of a picture in any of Pillow's modes; 16 bits become 8."""
    if _holds_words(image):
        return (np.asarray(image).astype(np.uint16) // 257).astype(np.uint8)
    if image.mode.startswith(("I", "F")):
        raise ValueError("its pixels are 32-bit numbers, not colours of 8 or 16 bits")
    if "A" in image.mode or "a" in image.mode or "transparency" in image.info:
        return np.array(image.convert("RGBA"))
    return np.array(image.convert("RGB"))


def _holds_words(image: Image.Image) -> bool:
    """Check for a grey picture of 16 bits; older versions of Pillow widen those of a PNG to 32."""
    return image.mode.startswith("I;16") or (image.mode == "I" and isinstance(image, PngImagePlugin.PngImageFile))


@contextlib.contextmanager
def _opened(source: Path | bytes, name: str, limits: PictureLimits) -> Iterator[tuple[ImageFile.ImageFile, str]]:
    """A picture whose header is read and within the limits, and its format; raises as :func:`picture_header`.

    Errors of decoding inside the block become DamagedFile too.
    """
    name = name or (str(source) if isinstance(source, Path) else "the picture")
    maker = stage_of_file(source) if isinstance(source, Path) else ""
    with contextlib.ExitStack() as stack, warnings.catch_warnings():
        # Pillow has limits of its own, and looks at the frames of GIF and WebP while it opens them.
        warnings.simplefilter("error", Image.DecompressionBombWarning)
        warnings.simplefilter("ignore", UserWarning)
        if isinstance(source, bytes):
            handle = io.BytesIO(source)
        else:
            handle = stack.enter_context(open_regular(source, "a picture", limits.max_file_bytes, maker))
        with _decoding(name, maker, limits):
            kind, reader = _reader_of(handle.read(12))
            handle.seek(0)
            image = stack.enter_context(reader(handle))
            _require_within(image.size, name, maker, limits)
            if getattr(image, "n_frames", 1) > 1:
                raise ValueError("it has several frames or pages; one still picture is expected")
            yield image, kind


@contextlib.contextmanager
def _decoding(name: str, maker: str, limits: PictureLimits) -> Iterator[None]:
    """Turn errors of Pillow's readers into errors that name the picture."""
    try:
        yield
    except VcageError:
        raise
    except (Image.DecompressionBombError, Image.DecompressionBombWarning) as error:
        pixels = "".join(c for c in str(error).partition(")")[0] if c.isdecimal())
        raise _oversized(name, f"{pixels} pixels; {_most(limits)}", maker) from error
    except SyntaxError as error:
        raise _unreadable(name, "its header is damaged, or of a kind that is not read", maker) from error
    except Exception as error:  # Pillow's readers raise whatever a broken file makes them raise
        raise _unreadable(name, str(error), maker) from error


def _reader_of(head: bytes) -> tuple[str, type[ImageFile.ImageFile]]:
    if not head:
        raise ValueError("it is empty")
    for magic, reader in _READERS.items():
        if head.startswith(magic):
            return reader
    raise ValueError(f"it is none of {', '.join(FORMATS)}")


def _require_within(size: tuple[int, int], name: str, maker: str, limits: PictureLimits) -> None:
    width, height = size
    if min(size) < 1:
        raise ValueError(f"it has {width} x {height} pixels")
    if width * height > limits.max_pixels or max(size) > limits.max_edge_px:
        raise _oversized(name, f"{width} x {height} pixels; {_most(limits)}", maker, width=width, height=height)


def _most(limits: PictureLimits) -> str:
    return f"at most {limits.max_pixels:,} pixels and {limits.max_edge_px:,} along an edge are read"


def _unreadable(name: str, why: str, maker: str) -> DamagedFile:
    return DamagedFile(f"{name} cannot be read as a picture: {why}", hint="save it again as PNG or JPEG", maker=maker)


def _oversized(name: str, found: str, maker: str, **details: int) -> OversizedFile:
    return OversizedFile(
        f"{name} is too large: {found}", hint="scale the picture down", maker=maker, details={"path": name, **details}
    )


def rgb_of_decoded(picture: np.ndarray) -> np.ndarray:
    """(H, W, 3) uint8 RGB from OpenCV's decoder; 16 bits become 8, grey becomes RGB, alpha is laid over white."""
    if picture.dtype == np.uint16:
        picture = (picture // 257).astype(np.uint8)
    return cv2.cvtColor(three_channels(picture), cv2.COLOR_BGR2RGB)


def three_channels(picture: np.ndarray) -> np.ndarray:
    """(H, W, 3) of a uint8 picture that is grey (H, W), or has three channels or four; alpha is laid over white."""
    if picture.ndim == 2:
        return cv2.cvtColor(picture, cv2.COLOR_GRAY2RGB)
    if picture.shape[2] == 4:
        alpha = picture[..., 3:].astype(np.float32) / 255
        return np.round(picture[..., :3] * alpha + 255 * (1 - alpha)).astype(np.uint8)
    return picture
