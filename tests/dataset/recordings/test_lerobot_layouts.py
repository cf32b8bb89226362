from __future__ import annotations

import json
import shutil

import numpy as np
import pytest

from tests.dataset.conftest import LENGTHS
from tests.recordings import CAMERAS, FPS, clip, episode
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
        for number, camera in enumerate(CAMERAS):
            true = clip(length, number).astype(int)
            assert np.abs(recording.pictures(camera) - true).mean() < 6
            assert np.array_equal(recording.pictures(camera, [2, 7]), recording.pictures(camera)[[2, 7]])


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
