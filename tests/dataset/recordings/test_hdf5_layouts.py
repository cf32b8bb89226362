from __future__ import annotations

import h5py
import numpy as np
import pytest

from tests.dataset.recordings.layouts import FRAMES, HEIGHT, WIDTH, act, jpeg, robotwin, robotwin_vision, room, rooms
from vcage.dataset.recordings.hdf5_layouts import open_hdf5
from vcage.errors import DamagedFile, UnknownName


def far(pictures: np.ndarray) -> float:
    """Mean difference to the true colours, levels."""
    return float(np.abs(pictures.astype(int) - rooms()).mean())


@pytest.mark.parametrize("swapped", [True, False])
def test_robotwins_pictures_come_in_their_true_colours_however_they_were_written(tmp_path, swapped):
    recording = open_hdf5(robotwin(tmp_path / "a.hdf5", swapped=swapped))
    assert recording.LAYOUT == "robotwin"
    assert far(recording.pictures("head_camera")) < 3
    assert any("swapped" in note for note in recording.notes) == swapped


def test_where_colours_do_not_say_robotwins_first_layout_counts_as_swapped(tmp_path):
    grey = np.full((FRAMES, HEIGHT, WIDTH, 3), 120, np.uint8)
    recording = open_hdf5(robotwin(tmp_path / "a.hdf5", pictures=grey))
    recording.pictures("head_camera")
    assert recording.notes


@pytest.mark.parametrize("swapped", [True, False])
def test_robotwins_second_layout_is_read_in_true_colours(tmp_path, swapped):
    recording = open_hdf5(robotwin_vision(tmp_path / "a.hdf5", swapped=swapped))
    assert (recording.LAYOUT, [camera.name for camera in recording.cameras]) == ("robotwin-1.0", ["cam_head"])
    assert far(recording.pictures("cam_head")) < 3
    assert recording.motion.action.shape == (FRAMES, 7)
    assert recording.motion.grippers == (6,)


@pytest.mark.parametrize("encoded", [True, False])
def test_acts_layout_holds_arrays_or_padded_jpeg(tmp_path, encoded):
    recording = open_hdf5(act(tmp_path / "a.hdf5", encoded=encoded))
    camera = recording.camera("cam_high")
    assert (recording.LAYOUT, camera.storage) == ("act", "jpeg" if encoded else "raw")
    assert (camera.frames, camera.width, camera.height) == (FRAMES, WIDTH, HEIGHT)
    assert far(recording.pictures("cam_high")) < 3
    assert recording.motion.grippers == (6, 13)


def test_an_arm_and_a_gripper_at_a_time_make_robotwins_commands(tmp_path):
    motion = open_hdf5(robotwin(tmp_path / "a.hdf5")).motion
    assert (motion.action.shape, motion.grippers) == ((FRAMES, 14), (6, 13))
    assert motion.action[0, 6] == 1 and motion.action[-1, 13] == 0


def test_an_episode_of_ours_is_known_and_says_its_frame_rate(finished):
    episode = next(finished.run.root.rglob("*.hdf5"))
    recording = open_hdf5(episode)
    assert (recording.LAYOUT, recording.fps) == ("vcage", 5)
    assert {camera.storage for camera in recording.cameras} == {"raw"}


def test_pictures_at_some_indices_are_those_of_all(tmp_path):
    recording = open_hdf5(act(tmp_path / "a.hdf5"))
    assert np.array_equal(recording.pictures("cam_high", [1, 4]), recording.pictures("cam_high")[[1, 4]])


def test_an_unknown_camera_is_named_beside_those_there_are(tmp_path):
    with pytest.raises(UnknownName, match="cam_low"):
        open_hdf5(act(tmp_path / "a.hdf5")).pictures("cam_low")


def test_a_picture_of_another_size_is_named(tmp_path):
    path = tmp_path / "a.hdf5"
    with h5py.File(path, "w") as file:
        files = [jpeg(room()), jpeg(room()[:16])]
        file["observation/head_camera/rgb"] = np.array(files, dtype=f"S{max(map(len, files))}")
    with pytest.raises(DamagedFile, match="picture 1 is 48x16, the first 48x32"):
        open_hdf5(path).pictures("head_camera")


@pytest.mark.parametrize("shape", [(), (1,), (4,)])
def test_grey_and_rgba_arrays_become_rgb(tmp_path, shape):
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file["observations/images/top"] = np.full((3, HEIGHT, WIDTH, *shape), 255, np.uint8)
    pictures = open_hdf5(tmp_path / "a.hdf5").pictures("top")
    assert pictures.shape == (3, HEIGHT, WIDTH, 3) and (pictures == 255).all()


def test_a_command_that_is_no_number_is_named(tmp_path):
    with h5py.File(act(tmp_path / "a.hdf5"), "r+") as file:
        file["action"][3, 2] = np.nan
    with pytest.raises(DamagedFile, match="action of frame 3"):
        _ = open_hdf5(tmp_path / "a.hdf5").motion


def test_an_episode_without_frames_is_refused(tmp_path):
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file["observations/images/top"] = np.zeros((0, HEIGHT, WIDTH, 3), np.uint8)
    with pytest.raises(DamagedFile, match="holds no frame"):
        _ = open_hdf5(tmp_path / "a.hdf5").cameras


def test_a_file_that_is_cut_off_is_named(tmp_path):
    path = act(tmp_path / "a.hdf5")
    path.write_bytes(path.read_bytes()[:1000])
    with pytest.raises(DamagedFile, match=r"a\.hdf5 is damaged"):
        open_hdf5(path)


def test_a_layout_that_nobody_knows_is_refused_with_what_it_holds(tmp_path):
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file["data/demo_0/thing"] = np.zeros(3)
    with pytest.raises(DamagedFile, match="data/demo_0"):
        open_hdf5(tmp_path / "a.hdf5")
