from __future__ import annotations

import cv2
import h5py
import numpy as np
import pytest

from tests.datasets.recordings.layouts import jpeg, room, rooms
from vcage.base.errors import DamagedFile
from vcage.datasets.stored_pictures import (
    channels_of,
    decode_picture,
    picture_channels,
    picture_kind,
    picture_storage,
    storage_of,
    stored_picture,
)


def test_padding_behind_a_picture_is_ignored():
    plain = decode_picture(jpeg(room()), "it")
    assert np.array_equal(plain, decode_picture(jpeg(room()) + bytes(100), "it"))


def png(pixels: np.ndarray) -> bytes:
    return cv2.imencode(".png", pixels)[1].tobytes()


def test_alpha_of_a_picture_file_is_laid_over_white():
    pixels = np.zeros((4, 6, 4), np.uint8)
    pixels[:, 3:, 3] = 255
    picture = decode_picture(png(pixels), "it")
    assert (picture[:, :3] == 255).all() and (picture[:, 3:] == 0).all()


@pytest.mark.parametrize("shape", [(4, 6), (4, 6, 3)])
def test_sixteen_bits_are_never_squeezed_to_eight(shape):
    with pytest.raises(DamagedFile, match="camera 0 is uint16"):
        decode_picture(png(np.full(shape, 257 * 7, np.uint16)), "camera 0")


@pytest.mark.parametrize(("shape", "channels"), [((4, 6), 1), ((4, 6, 3), 3), ((4, 6, 4), 4)])
def test_a_picture_file_says_how_many_channels_it_has(shape, channels):
    assert channels_of(png(np.zeros(shape, np.uint8)), "it") == channels


@pytest.mark.parametrize("read", [decode_picture, channels_of])
@pytest.mark.parametrize("data", [b"", b"\x89PNG and no more"])
def test_a_damaged_picture_file_is_named(read, data):
    with pytest.raises(DamagedFile, match="camera 0"):
        read(data, "camera 0")


@pytest.mark.parametrize("data", [b"", b"GIF89a"])
def test_an_unknown_picture_format_is_refused(data):
    with pytest.raises(DamagedFile, match="camera 0"):
        storage_of(data, "camera 0")


FILE = jpeg(room())


def padded(file: h5py.File) -> h5py.Dataset:
    return file.create_dataset("it", data=np.frombuffer(FILE + bytes(9), np.uint8)[None])


def vlen(file: h5py.File) -> h5py.Dataset:
    dataset = file.create_dataset("it", (1,), h5py.vlen_dtype(np.uint8))
    dataset[0] = np.frombuffer(FILE, np.uint8)
    return dataset


KINDS = {
    "array": lambda file: file.create_dataset("it", data=rooms()),
    "fixed": lambda file: file.create_dataset("it", data=np.array([FILE], f"S{len(FILE) + 9}")),
    "padded": padded,
    "vlen": vlen,
}


@pytest.mark.parametrize("kind", KINDS)
def test_pictures_are_read_from_every_kind_of_dataset(tmp_path, kind):
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        dataset = KINDS[kind](file)
        assert picture_kind(dataset) == kind
        assert picture_storage(dataset, "it") == ("raw" if kind == "array" else "jpeg")
        assert picture_channels(dataset, "it") == 3
        assert np.abs(stored_picture(dataset, 0, "it").astype(int) - room()).mean() < 3


def test_an_array_of_other_numbers_is_no_picture(tmp_path):
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        dataset = file.create_dataset("it", data=np.zeros((2, 8, 8, 3), np.float32))
        with pytest.raises(DamagedFile, match=r"depth\[1\]"):
            stored_picture(dataset, 1, "depth")


@pytest.mark.parametrize(
    "stored",
    [
        {},
        {"chunks": (1, 48, 64, 3), "compression": "gzip"},
        {"chunks": (1, 48, 64, 3), "compression": "gzip", "shuffle": True},
        {"chunks": (1, 48, 64, 3), "compression": "gzip", "fletcher32": True},
        {"chunks": (1, 48, 64, 3), "compression": "lzf"},
        {"chunks": (2, 48, 64, 3), "compression": "gzip"},
        {"chunks": (1, 24, 64, 3), "compression": "gzip"},
    ],
)
def test_an_array_is_read_however_it_is_packed(tmp_path, stored):
    pictures = np.random.default_rng(0).integers(0, 256, (3, 48, 64, 3), np.uint8)
    with h5py.File(tmp_path / "pictures.hdf5", "w") as file:
        dataset = file.create_dataset("images", (4, 48, 64, 3), np.uint8, **stored)
        dataset[:3] = pictures
        found = [stored_picture(dataset, index, "it") for index in range(4)]
    assert np.array_equal(found, [*pictures, np.zeros((48, 64, 3), np.uint8)])  # the last was never written


@pytest.mark.parametrize("spoil", [lambda packed: packed[:-9], lambda packed: bytes(len(packed))])
def test_a_damaged_chunk_is_an_error_of_hdf5(tmp_path, spoil):
    chunks = (1, *room().shape)
    with h5py.File(tmp_path / "pictures.hdf5", "w") as file:
        dataset = file.create_dataset("images", data=np.stack([room()] * 2), chunks=chunks, compression="gzip")
        _, packed = dataset.id.read_direct_chunk((1, 0, 0, 0))
        dataset.id.write_direct_chunk((1, 0, 0, 0), spoil(packed))
        assert np.array_equal(stored_picture(dataset, 0, "it"), room())
        with pytest.raises(OSError):
            stored_picture(dataset, 1, "it")
