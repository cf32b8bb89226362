from __future__ import annotations

import h5py
import numpy as np
import pytest

from tests.datasets.recordings.layouts import jpeg, room, rooms
from vcage.base.errors import DamagedFile
from vcage.datasets.picture_datasets import picture_channels, picture_kind, picture_storage, stored_picture

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
