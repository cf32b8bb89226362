from __future__ import annotations

import pytest

from tests.datasets.packed_files import pack
from tests.datasets.recordings.layouts import act, jpeg, robotwin, room
from vcage.datasets.recordings.opening import open_recordings


def test_a_recording_is_read_from_its_hdf5_file_alone(tmp_path):
    assert open_recordings(act(tmp_path / "a.hdf5"))[0].files == [tmp_path / "a.hdf5"]


def test_a_packed_recording_is_read_from_its_videos_too(tmp_path):
    (packed,) = open_recordings(pack(robotwin(tmp_path / "a.hdf5"), tmp_path / "small/a.hdf5"))
    assert [file.name for file in packed.files] == ["a.hdf5", "a.head_camera.mp4", "a.left_camera.mp4"]


def test_a_folder_of_pictures_is_read_from_each_of_them(tmp_path):
    for index in (10, 2):
        (tmp_path / f"{index}.jpg").write_bytes(jpeg(room()))
    assert [file.name for file in open_recordings(tmp_path)[0].files] == ["2.jpg", "10.jpg"]


@pytest.mark.parametrize("version", ["v21", "v3"])
def test_an_episode_of_a_data_set_is_read_from_its_table_videos_and_metadata(request, version):
    root = request.getfixturevalue(version)
    files = open_recordings(root)[0].files
    assert root / "meta/info.json" in files
    suffixes = [file.suffix for file in files]
    assert suffixes.count(".mp4") == 3 and ".parquet" in suffixes


def test_notes_are_reported_once_however_often_the_numbers_are_read(tmp_path):
    (recording,) = open_recordings(robotwin(tmp_path / "a.hdf5"))
    assert recording.notes == recording.notes and len(recording.notes) == len(set(recording.notes)) == 2
    assert recording.state_notes == recording.state_notes and len(recording.state_notes) == 1


def test_names_are_read_once_for_any_number_of_uses(tmp_path):
    (recording,) = open_recordings(act(tmp_path / "a.hdf5"))
    names = recording.state_names, recording.action_names
    (tmp_path / "a.hdf5").unlink()
    assert (recording.state_names, recording.action_names) == names
