from __future__ import annotations

import h5py
import numpy as np
import pytest

from tests.datasets.recordings import layouts
from vcage.base.errors import DamagedFile, OversizedFile
from vcage.datasets.hdf5_contents import require_numbers_fit, require_pictures_fit, require_readable
from vcage.datasets.recordings.opening import open_hdf5


@pytest.fixture
def file(tmp_path):
    with h5py.File(tmp_path / "file.hdf5", "w") as file:
        yield file


def test_declared_but_missing_numbers_are_refused_with_their_size(file):
    dataset = file.create_dataset("action", (10**9, 7), np.float32, chunks=(1000, 7), compression="gzip")
    with pytest.raises(OversizedFile, match=r"file\.hdf5:/action is too large: .* 28,000,000,000 bytes"):
        require_numbers_fit(dataset)


@pytest.mark.parametrize(
    ("shape", "chunks", "named"),
    [
        ((6, 30_000, 30_000, 3), (1, 100, 100, 3), "2,700,000,000 bytes"),
        ((10**9, 48, 64, 3), (1, 48, 64, 3), "1,000,000,000 pictures"),
        ((6, 48, 64, 3), (400_000, 48, 64, 3), "a chunk of it has 3,686,400,000 bytes"),
    ],
)
def test_pictures_that_do_not_fit_in_memory_are_refused_with_their_size(file, shape, chunks, named):
    dataset = file.create_dataset("top", shape, np.uint8, chunks=chunks, maxshape=(None, *shape[1:]))
    with pytest.raises(OversizedFile, match=named):
        require_pictures_fit(dataset)


def test_a_missing_filter_is_named(file):
    properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    properties.set_chunk((4,))
    properties.set_filter(32026, h5py.h5z.FLAG_OPTIONAL, (1,))
    space = h5py.h5s.create_simple((4,))
    h5py.h5d.create(file.id, b"action", h5py.h5t.NATIVE_DOUBLE, space, properties)
    with pytest.raises(DamagedFile, match=r"/action is compressed by the filter 32026 \(Blosc2\)"):
        require_readable(file["action"])


@pytest.mark.parametrize(
    ("make", "key"),
    [
        (layouts.act, "action"),
        (layouts.robotwin, "joint_action/left_arm"),
        (layouts.robotwin_vision, "action/left_arm"),
        (layouts.robomimic, "data/demo_0/actions"),
    ],
)
def test_every_layout_bounds_the_numbers_that_it_reads(tmp_path, make, key):
    path = make(tmp_path / "file.hdf5")
    with h5py.File(path, "r+") as file:
        del file[key]
        file.create_dataset(key, (10**9, 7), np.float32, chunks=(1000, 7))
    with pytest.raises(OversizedFile, match=f":/{key} is too large"):
        _ = open_hdf5(path).motion
