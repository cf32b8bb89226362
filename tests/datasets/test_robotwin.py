from __future__ import annotations

import cv2
import h5py
import numpy as np
import pytest

from tests.recordings import CAMERAS, FPS, HEIGHT, INSTRUCTION, STATE_NAMES, WIDTH, clip, episode, pictures, written
from vcage.base.errors import OutputFolderError, UsageError
from vcage.datasets.episode import CameraTrack, EpisodeData
from vcage.datasets.hdf5 import write_episode
from vcage.datasets.reader import EpisodeReader
from vcage.datasets.recordings.opening import open_recordings
from vcage.datasets.robotwin import export_robotwin

FRAMES = 9


def exported(path, out):
    with EpisodeReader(path) as reader:
        return export_robotwin(reader, out)


@pytest.fixture
def file(tmp_path):
    return exported(written(tmp_path / "episode.hdf5", FRAMES), tmp_path / "out" / "episode0.hdf5")


def targets(data: EpisodeData) -> np.ndarray:
    """(T, D) at the frames themselves, of which RoboTwin's readers take the next for an action."""
    return np.array([data.qpos[0], *data.action[:-1]])


def test_the_file_is_read_as_a_robotwin_recording_that_only_jpeg_changes(file):
    (recording,) = open_recordings(file)
    assert (recording.LAYOUT, recording.fps, recording.task) == ("robotwin", FPS, INSTRUCTION)
    assert recording.robot == "dual_panda"
    assert np.array_equal(recording.motion.values[:-1], episode(FRAMES).action[:-1])
    assert np.array_equal(recording.state, episode(FRAMES).qpos)
    assert recording.motion.grippers == (2, 5)
    assert [camera.name for camera in recording.cameras] == ["head_camera", "left_camera", "right_camera"]
    for number, camera in enumerate(recording.cameras):
        assert np.array_equal(recording.pictures(camera.name), [through_jpeg(one) for one in clip(FRAMES, number)])


def through_jpeg(picture: np.ndarray) -> np.ndarray:
    """Return a picture after a JPEG with red and blue swapped."""
    return cv2.imdecode(cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, 95])[1], cv2.IMREAD_COLOR)


def test_robotwins_own_readers_get_rgb_from_opencv(file):
    with h5py.File(file) as plain:
        data = plain["observation/head_camera/rgb"][3]
    picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    assert np.abs(picture.astype(int) - clip(FRAMES)[3]).mean() < 10
    assert np.abs(picture[..., ::-1].astype(int) - clip(FRAMES)[3]).mean() > 20


def test_every_field_that_robotwins_readers_need_is_written(file):
    with h5py.File(file) as plain:
        assert plain["joint_action/left_arm"].shape == (FRAMES, 2)
        assert plain["joint_action/right_gripper"].shape == (FRAMES,)
        assert np.array_equal(plain["joint_action/vector"], targets(episode(FRAMES)))
        for camera in plain["observation"].values():
            assert camera["rgb"].dtype.kind == "S" and camera["rgb"].shape == (FRAMES,)
            assert camera["intrinsic_cv"].shape == (FRAMES, 3, 3)
            assert camera["extrinsic_cv"].shape == (FRAMES, 3, 4)
            assert camera["cam2world_gl"].shape == (FRAMES, 4, 4)


def test_a_camera_looks_along_minus_z_in_opengls_axes(tmp_path):
    extrinsics = np.tile(np.eye(4), (FRAMES, 1, 1))
    extrinsics[:, :3, 3] = [0, 0, 2]  # the camera stands at z = -2 and looks along +z
    track = CameraTrack(WIDTH, HEIGHT, np.diag([50.0, 50.0, 1.0]), extrinsics)
    path = written(tmp_path / "a.hdf5", FRAMES, cameras=dict.fromkeys(CAMERAS, track))
    with h5py.File(exported(path, tmp_path / "b.hdf5")) as plain:
        pose = plain["observation/head_camera/cam2world_gl"][0]
        assert np.allclose(pose[:3, 3], [0, 0, -2])
        assert np.allclose(pose[:3, :3] @ [0, 0, -1], [0, 0, 1])
        assert np.allclose(plain["observation/head_camera/extrinsic_cv"][0], extrinsics[0, :3])


def test_one_arm_is_written_without_the_other(tmp_path):
    one = {name: getattr(episode(FRAMES), name)[:, :3] for name in ("qpos", "qvel", "action")}
    names = [name.replace("left", "right") for name in STATE_NAMES[:3]]
    whole = episode(FRAMES, state_names=names, **one)
    path = write_episode(tmp_path / "a.hdf5", whole, pictures(FRAMES))
    out = exported(path, tmp_path / "b.hdf5")
    with h5py.File(out) as plain:
        assert sorted(plain["joint_action"]) == ["right_arm", "right_gripper", "vector"]
    (recording,) = open_recordings(out)
    assert np.array_equal(recording.state, one["qpos"])


def test_a_camera_of_another_name_keeps_it(tmp_path):
    track = episode(FRAMES).cameras["cam_high"]
    frames = ({"cam_low": mapping["cam_high"]} for mapping in pictures(FRAMES))
    path = write_episode(tmp_path / "a.hdf5", episode(FRAMES, cameras={"cam_low": track}), frames)
    (recording,) = open_recordings(exported(path, tmp_path / "b.hdf5"))
    assert [camera.name for camera in recording.cameras] == ["cam_low"]


def test_an_arm_that_robotwin_does_not_know_is_refused_by_name(tmp_path):
    names = [name.replace("right", "third") for name in STATE_NAMES]
    path = written(tmp_path / "a.hdf5", FRAMES, state_names=names)
    with pytest.raises(UsageError, match="third_joint_1"):
        exported(path, tmp_path / "b.hdf5")
    assert not (tmp_path / "b.hdf5").exists()


def test_a_folder_that_cannot_be_made_is_named(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(OutputFolderError, match=r"b\.hdf5"):
        exported(written(tmp_path / "a.hdf5", 2), tmp_path / "file" / "b.hdf5")


def test_some_frames_alone_keep_pictures_joints_and_calibration_together(tmp_path):
    source, frames = written(tmp_path / "episode.hdf5", FRAMES), np.array([0, 3, FRAMES - 1])
    with EpisodeReader(source) as reader:
        whole = export_robotwin(reader, tmp_path / "whole.hdf5")
        some = export_robotwin(reader, tmp_path / "some.hdf5", frames)
    with h5py.File(whole) as every, h5py.File(some) as kept:
        for key in ("joint_action/vector", "joint_state/vector", "observation/head_camera/extrinsic_cv"):
            assert np.array_equal(kept[key], every[key][frames])
        rgb = "observation/head_camera/rgb"
        assert [bytes(one) for one in kept[rgb]] == [bytes(every[rgb][frame]) for frame in frames]
