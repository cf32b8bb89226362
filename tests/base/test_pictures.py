"""Picture files: reading, and refusals before decoding."""

from __future__ import annotations

import io
import os
import struct
import zlib

import cv2
import numpy as np
import pytest
from PIL import Image

from vcage.base.errors import DamagedFile, InputFileError, MissingStage, OversizedFile
from vcage.base.pictures import (
    PictureHeader,
    picture_header,
    read_labels,
    read_picture,
    write_labels,
    write_picture,
)

PICTURE = (np.indices((20, 30)).sum(axis=0)[..., None] * [2, 3, 5]).astype(np.uint8)


def encoded(kind: str, **options: object) -> bytearray:
    """A file of :data:`PICTURE` in one of Pillow's formats."""
    buffer = io.BytesIO()
    Image.fromarray(PICTURE).save(buffer, kind, **options)
    return bytearray(buffer.getvalue())


def declaring(kind: str) -> bytes:
    """A small file whose header declares far more pixels than any memory holds."""
    data = encoded(kind)
    match kind:
        case "PNG":
            data[16:24] = struct.pack(">II", 30_000, 30_000)
            data[29:33] = struct.pack(">I", zlib.crc32(data[12:29]))
        case "JPEG":
            at = data.index(b"\xff\xc0") + 5
            data[at : at + 4] = struct.pack(">HH", 30_000, 30_000)
        case "BMP":
            data[18:26] = struct.pack("<ii", 30_000, 30_000)
        case "GIF":
            data[6:10] = struct.pack("<HH", 30_000, 30_000)
        case "WEBP":
            at = data.index(b"\x9d\x01\x2a") + 3
            data[at : at + 4] = struct.pack("<HH", 16_383, 16_383)
        case "TIFF":
            first = struct.unpack("<I", data[4:8])[0] + 2
            for at in (first, first + 12):  # width and height come first
                data[at + 2 : at + 12] = struct.pack("<HII", 4, 1, 30_000)
    return bytes(data)


def test_a_picture_and_labels_come_back_as_they_were(tmp_path):
    picture = np.random.default_rng(0).integers(0, 256, (5, 7, 3), dtype=np.uint8)
    labels = np.arange(35, dtype=np.int32).reshape(5, 7) * 100
    np.testing.assert_array_equal(read_picture(write_picture(tmp_path / "a.png", picture)), picture)
    np.testing.assert_array_equal(read_labels(write_labels(tmp_path / "b.png", labels)), labels)
    assert read_picture(tmp_path / "a.png").flags.writeable


@pytest.mark.parametrize("data", [b"", b"no picture", b"\x89PNG\r\n\x1a\n"])
@pytest.mark.parametrize("read", [read_picture, read_labels])
def test_a_file_that_is_no_picture_is_named(read, data, tmp_path):
    path = tmp_path / "target.png"
    path.write_bytes(data)
    with pytest.raises(DamagedFile, match=r"target\.png"):
        read(path)


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP", "BMP", "TIFF", "GIF"])
def test_every_common_format_is_read_by_its_content(kind, tmp_path):
    path = tmp_path / "target.png"
    path.write_bytes(encoded(kind))
    assert picture_header(path) == PictureHeader({"WEBP": "WebP"}.get(kind, kind), 30, 20)
    assert np.abs(read_picture(path).astype(int) - PICTURE).mean() < 6


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP", "BMP", "TIFF", "GIF"])
@pytest.mark.parametrize("read", [picture_header, read_picture, read_labels])
def test_a_picture_that_declares_too_many_pixels_is_refused_by_its_size(read, kind, tmp_path):
    path = tmp_path / "target.png"
    path.write_bytes(declaring(kind))
    with pytest.raises(OversizedFile, match=r"target\.png is too large: (30000 x 30000|268402689) pixels"):
        read(path)


def test_a_picture_as_thin_as_a_line_has_a_longest_edge():
    with pytest.raises(OversizedFile, match="20000 x 1 pixels"):
        read_picture(cv2.imencode(".png", np.zeros((1, 20_000), np.uint8))[1].tobytes(), "the answer")


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP", "BMP", "TIFF", "GIF"])
def test_a_picture_that_was_cut_off_is_refused(kind):
    data = encoded(kind)
    with pytest.raises(DamagedFile, match="the answer cannot be read as a picture"):
        read_picture(bytes(data[: len(data) * 2 // 3]), "the answer")


@pytest.mark.parametrize("kind", ["PNG", "WEBP", "TIFF", "GIF"])
def test_of_several_frames_none_is_chosen(kind):
    other = Image.fromarray(PICTURE[::-1])
    with pytest.raises(DamagedFile, match="several frames"):
        read_picture(bytes(encoded(kind, save_all=True, append_images=[other])))


def test_sixteen_bits_become_eight_and_numbers_are_no_colours():
    sixteen = cv2.imencode(".png", PICTURE[..., ::-1].astype(np.uint16) * 257)[1].tobytes()
    np.testing.assert_array_equal(read_picture(sixteen), PICTURE)
    grey = read_picture(cv2.imencode(".png", PICTURE[..., 0].astype(np.uint16) * 257)[1].tobytes())
    np.testing.assert_array_equal(grey, np.repeat(PICTURE[..., :1], 3, axis=2))
    with pytest.raises(DamagedFile, match="32-bit"):
        buffer = io.BytesIO()
        Image.fromarray(PICTURE[..., 0].astype(np.float32)).save(buffer, "TIFF")
        read_picture(buffer.getvalue())


def test_alpha_is_laid_over_white_and_a_turned_photograph_stands_upright():
    clear = np.dstack([PICTURE, np.zeros((20, 30), np.uint8)])
    assert (read_picture(cv2.imencode(".png", clear)[1].tobytes()) == 255).all()
    turned = Image.Exif()
    turned[0x112] = 6
    assert read_picture(bytes(encoded("JPEG", exif=turned))).shape == (30, 20, 3)


def test_a_pipe_a_device_and_a_folder_are_no_pictures(tmp_path):
    os.mkfifo(tmp_path / "pipe.png")
    (tmp_path / "endless.png").symlink_to("/dev/zero")
    (tmp_path / "folder.png").mkdir()
    for name in ("pipe", "endless", "folder"):
        with pytest.raises(InputFileError, match=rf"{name}\.png is a (device|pipe|folder), not a picture"):
            read_picture(tmp_path / f"{name}.png")


def test_a_huge_file_is_refused_by_its_bytes(tmp_path):
    with (tmp_path / "long.png").open("wb") as handle:
        handle.write(b"\x89PNG\r\n\x1a\n")
        handle.truncate(10**10)
    with pytest.raises(OversizedFile, match="10,000,000,000 of at most"):
        read_picture(tmp_path / "long.png")


def test_a_missing_picture_is_named(tmp_path):
    with pytest.raises(MissingStage, match=r"target\.png"):
        read_picture(tmp_path / "target.png")


def test_a_colour_picture_is_no_label_image(tmp_path):
    with pytest.raises(DamagedFile, match="label"):
        read_labels(write_picture(tmp_path / "a.png", np.zeros((4, 4, 3), np.uint8)))
