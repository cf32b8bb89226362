from __future__ import annotations

import h5py
import numpy as np
import pytest

from tests.datasets.recordings.layouts import act, jpeg, robotwin, robotwin_vision, room
from vcage.base.errors import InputFileError
from vcage.datasets.recordings.hdf5_recording import COLOURS
from vcage.datasets.recordings.opening import open_recordings


def test_a_folder_of_files_gives_a_recording_each_whatever_their_layout(tmp_path):
    (tmp_path / "data").mkdir()
    act(tmp_path / "data" / "b.hdf5")
    robotwin(tmp_path / "a.h5")
    assert [(one.path.name, one.LAYOUT) for one in open_recordings(tmp_path)] == [
        ("a.h5", "robotwin"),
        ("b.hdf5", "act"),
    ]


def test_a_folder_of_pictures_is_one_recording(tmp_path):
    (tmp_path / "0.jpg").write_bytes(jpeg(room()))
    assert [one.LAYOUT for one in open_recordings(tmp_path)] == ["pictures"]


def test_recordings_that_lie_together_have_their_colours_in_one_order(tmp_path):
    cold = np.stack([room(index)[..., ::-1] for index in range(6)])
    for name in "abcd":
        robotwin_vision(tmp_path / f"{name}.hdf5", swapped=True)
    robotwin_vision(tmp_path / "e.hdf5", swapped=True, pictures=cold)
    alone, *_, last = open_recordings(tmp_path / "e.hdf5") + open_recordings(tmp_path)
    assert not alone.swapped("cam_head") and last.swapped("cam_head")
    assert np.abs(last.pictures("cam_head").astype(int) - cold).mean() < 3


def test_a_recording_that_says_its_colours_is_believed_beside_others(tmp_path):
    for name in "abc":
        robotwin_vision(tmp_path / f"{name}.hdf5", swapped=True)
    with h5py.File(tmp_path / "c.hdf5", "r+") as file:
        file.attrs[COLOURS] = "true"
    assert [one.swapped("cam_head") for one in open_recordings(tmp_path)] == [True, True, False]


@pytest.mark.parametrize("name", ["missing", "empty"])
def test_nothing_to_read_says_what_is_known(tmp_path, name):
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputFileError) as caught:
        open_recordings(tmp_path / name)
    assert name in str(caught.value) and caught.value.hint
