from __future__ import annotations

import json
import pickle
import shutil

import cv2
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.dataset.conftest import LENGTHS
from tests.recordings import CAMERAS, FPS, INSTRUCTION, STATE_NAMES, clip, episode
from vcage.dataset.recordings.opening import open_recordings
from vcage.errors import DamagedFile


@pytest.fixture(params=["v2.1", "v3.0"])
def dataset(request, v21, v3):
    return v21 if request.param == "v2.1" else v3


def test_every_episode_of_a_data_set_is_a_recording_with_its_pictures_and_commands(dataset):
    recordings = open_recordings(dataset)
    assert len(recordings) == len(LENGTHS)
    for recording, length in zip(recordings, LENGTHS, strict=True):
        assert (
            recording.LAYOUT.removeprefix("lerobot-")
            == json.loads((dataset / "meta/info.json").read_text())["codebase_version"]
        )
        assert recording.fps == FPS
        assert {camera.name: camera.frames for camera in recording.cameras} == dict.fromkeys(CAMERAS, length)
        assert np.allclose(recording.motion.action, episode(length).action, atol=1e-6)
        assert np.allclose(recording.state, episode(length).qpos, atol=1e-6)
        for number, camera in enumerate(CAMERAS):
            true = clip(length, number).astype(int)
            assert np.abs(recording.pictures(camera) - true).mean() < 6
            assert np.array_equal(recording.pictures(camera, [2, 7]), recording.pictures(camera)[[2, 7]])


def test_a_data_set_says_what_its_numbers_mean_and_what_the_robot_did(dataset):
    recording = open_recordings(dataset)[1]
    assert recording.state_names == recording.action_names == STATE_NAMES
    assert recording.motion.grippers == (2, 5)
    assert (recording.task, recording.robot) == (INSTRUCTION, "dual_panda")


def test_an_episode_of_a_data_set_goes_to_another_process(dataset):
    recording = open_recordings(dataset)[1]
    again = pickle.loads(pickle.dumps(recording))
    assert np.array_equal(again.pictures("cam_high", [3]), recording.pictures("cam_high", [3]))
    assert np.array_equal(again.state, recording.state)


def test_a_data_set_says_how_its_pictures_are_stored(dataset):
    recording = open_recordings(dataset)[0]
    for camera in recording.cameras:
        assert camera.storage == "hevc"
        assert 0 < camera.stored_bytes < camera.raw_bytes


def test_a_missing_video_is_named(dataset, tmp_path):
    copy = shutil.copytree(dataset, tmp_path / "copy")
    next(copy.rglob("*.mp4")).unlink()
    with pytest.raises(DamagedFile, match=r"\.mp4"):
        for recording in open_recordings(copy):
            _ = recording.cameras


def test_a_video_that_is_shorter_than_its_episode_is_named(v21, tmp_path):
    copy = shutil.copytree(v21, tmp_path / "copy")
    first, second = (recording._clip("observation.images.cam_high").file for recording in open_recordings(copy))
    shutil.copy(second, first)
    with pytest.raises(DamagedFile, match=r"episode 0 is longer than its video: .*\.mp4 has 9 frames"):
        open_recordings(copy)[0].pictures("cam_high")


def test_a_version_that_is_not_known_is_named(v3, tmp_path):
    copy = shutil.copytree(v3, tmp_path / "copy")
    info = json.loads((copy / "meta/info.json").read_text())
    (copy / "meta/info.json").write_text(json.dumps({**info, "codebase_version": "v1.6"}))
    with pytest.raises(DamagedFile, match=r"version v1\.6"):
        open_recordings(copy)


def test_a_missing_list_of_episodes_is_named(v21, tmp_path):
    copy = shutil.copytree(v21, tmp_path / "copy")
    (copy / "meta/episodes.jsonl").unlink()
    with pytest.raises(DamagedFile, match=r"episodes\.jsonl"):
        open_recordings(copy)


@pytest.fixture
def with_picture_files(v21, tmp_path):
    """A data set whose pictures lie in its tables, as PNG."""
    copy = shutil.copytree(v21, tmp_path / "copy")
    info = json.loads((copy / "meta/info.json").read_text())
    key = "observation.images.cam_high"
    info["features"] = {name: one for name, one in info["features"].items() if one["dtype"] != "video"}
    info["features"][key] = {"dtype": "image", "shape": [48, 64, 3], "names": ["height", "width", "channels"]}
    (copy / "meta/info.json").write_text(json.dumps(info))
    for index, length in enumerate(LENGTHS):
        path = copy / f"data/chunk-000/episode_{index:06d}.parquet"
        files = [{"bytes": cv2.imencode(".png", one[..., ::-1])[1].tobytes(), "path": None} for one in clip(length)]
        pq.write_table(pq.read_table(path).append_column(key, pa.array(files)), path)
    return copy


def test_pictures_in_the_tables_of_a_data_set_are_read(with_picture_files):
    for recording, length in zip(open_recordings(with_picture_files), LENGTHS, strict=True):
        (camera,) = recording.cameras
        assert (camera.storage, camera.frames, camera.channels) == ("png", length, 3)
        assert 0 < camera.stored_bytes < camera.raw_bytes
        assert np.array_equal(recording.pictures("cam_high"), clip(length))
        assert np.array_equal(recording.pictures("cam_high", [1, 5]), clip(length)[[1, 5]])
        assert recording.motion.action.shape == (length, 6)
