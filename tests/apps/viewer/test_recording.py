from __future__ import annotations

import cv2
import numpy as np
import pytest

from tests.apps.viewer.conftest import ReadBack
from tests.datasets.recordings.layouts import FRAMES, act, jpeg, robotwin, room, rooms
from tests.recordings import STATE_NAMES, episode
from vcage.apps.viewer.show import view
from vcage.base.errors import UsageError
from vcage.datasets.lerobot.episode import LeRobotEpisode
from vcage.datasets.lerobot.formats import open_writer
from vcage.datasets.recordings.opening import open_recordings


def test_a_recording_of_others_has_pictures_in_true_colours(tmp_path):
    view(robotwin(tmp_path / "a.hdf5"), save=tmp_path / "look.rrd")
    pictures = ReadBack(tmp_path / "look.rrd").rows("/cameras/head_camera", "Blob")
    shown = cv2.imdecode(np.array(pictures[2], np.uint8), cv2.IMREAD_COLOR)[..., ::-1]
    assert len(pictures) == FRAMES and np.abs(shown.astype(int) - rooms()[2]).mean() < 4


def test_its_state_and_commands_are_curves_under_their_names(tmp_path):
    path = act(tmp_path / "a.hdf5")
    (recording,) = open_recordings(path)
    view(path, save=tmp_path / "look.rrd")
    seen = ReadBack(tmp_path / "look.rrd")
    assert seen.under("/joints") == set(recording.action_names)
    name = recording.action_names[0]
    assert list(seen.rows(f"/joints/{name}/commanded", "Scalar").values()) == recording.motion.action[:, 0].tolist()


def test_without_a_frame_rate_there_are_frames_and_no_times(tmp_path):
    view(robotwin(tmp_path / "a.hdf5"), save=tmp_path / "look.rrd")
    seen = ReadBack(tmp_path / "look.rrd")
    assert list(seen.rows("/cameras/head_camera", "MediaType")) == list(range(FRAMES))
    assert seen.rows("/cameras/head_camera", "MediaType", "time") == {}
    assert "at unknown times" in seen.fixed("/about", "Text")


def test_a_frame_rate_that_is_given_gives_times(tmp_path):
    view(robotwin(tmp_path / "a.hdf5"), save=tmp_path / "look.rrd", fps=3)
    times = ReadBack(tmp_path / "look.rrd").rows("/cameras/head_camera", "MediaType", "time")
    assert list(times)[1:4] == [333_333_333, 666_666_667, 1_000_000_000]


@pytest.fixture
def numbers_alone(tmp_path):
    """A LeRobot data set without cameras, of one episode."""
    named = {"state_names": STATE_NAMES, "action_names": STATE_NAMES}
    numbers = {"state": episode(FRAMES).qpos, "action": episode(FRAMES).action}
    with open_writer("lerobot-v3.0", tmp_path / "set") as writer:
        writer.add(LeRobotEpisode(10.0, "robot", "push", videos={}, histograms={}, sampled=0, **numbers, **named))
    return tmp_path / "set"


def test_a_recording_of_numbers_alone_has_its_curves(numbers_alone, tmp_path):
    contents = view(numbers_alone, save=tmp_path / "look.rrd").contents
    assert (contents.frames, contents.cameras) == (FRAMES, {})
    assert ReadBack(tmp_path / "look.rrd").under("/joints") == set(STATE_NAMES)


def test_cameras_of_different_lengths_show_all_they_have(tmp_path):
    for camera, count in (("front", 2), ("side", 5)):
        (tmp_path / "set" / camera).mkdir(parents=True)
        for index in range(count):
            (tmp_path / "set" / camera / f"{index}.jpg").write_bytes(jpeg(room(index)))
    assert view(tmp_path / "set", save=tmp_path / "look.rrd").contents.frames == 5
    seen = ReadBack(tmp_path / "look.rrd")
    assert [len(seen.rows(f"/cameras/{name}", "MediaType")) for name in ("front", "side")] == [2, 5]


def test_it_has_no_compressed_videos(tmp_path):
    with pytest.raises(UsageError, match="compressed"):
        view(robotwin(tmp_path / "a.hdf5"), save=tmp_path / "look.rrd", footage="compressed")
