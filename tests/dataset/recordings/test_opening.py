from __future__ import annotations

import pytest

from tests.dataset.recordings.layouts import act, jpeg, robotwin, room
from vcage.dataset.recordings.opening import open_recordings
from vcage.errors import InputFileError


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


@pytest.mark.parametrize("name", ["missing", "empty"])
def test_nothing_to_read_says_what_is_known(tmp_path, name):
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputFileError) as caught:
        open_recordings(tmp_path / name)
    assert name in str(caught.value) and caught.value.hint
