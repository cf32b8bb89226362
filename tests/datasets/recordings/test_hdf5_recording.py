from __future__ import annotations

import pickle

import h5py
import numpy as np
import pytest

from tests.datasets.recordings.layouts import FRAMES, HEIGHT, WIDTH, act, jpeg, robotwin, robotwin_vision, room, rooms
from tests.recordings import FPS, INSTRUCTION, STATE_NAMES, episode, written
from vcage.base.errors import DamagedFile, UnknownName
from vcage.datasets.recordings.opening import open_hdf5


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
    assert recording.swapped("head_camera") and recording.notes


@pytest.mark.parametrize("swapped", [True, False])
def test_robotwins_second_layout_is_read_in_true_colours(tmp_path, swapped):
    recording = open_hdf5(robotwin_vision(tmp_path / "a.hdf5", swapped=swapped))
    assert (recording.LAYOUT, [camera.name for camera in recording.cameras]) == ("robotwin-1.0", ["cam_head"])
    assert far(recording.pictures("cam_head")) < 3
    assert recording.motion.values.shape == (FRAMES, 7)
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
    assert (motion.values.shape, motion.grippers) == ((FRAMES, 14), (6, 13))
    assert motion.values[0, 6] == 1 - 1 / (FRAMES - 1) and motion.values[-1, 13] == 0


def test_an_episode_of_ours_is_recognised_and_described(tmp_path):
    recording = open_hdf5(written(tmp_path / "a.hdf5", 6))
    assert (recording.LAYOUT, recording.fps, recording.task) == ("vcage", FPS, INSTRUCTION)
    assert recording.robot == "dual_panda"
    assert {camera.storage for camera in recording.cameras} == {"raw"}
    assert recording.state_names == recording.action_names == STATE_NAMES
    assert np.array_equal(recording.state, episode(6).qpos)
    assert recording.motion.grippers == (2, 5)


def test_pictures_at_some_indices_match_all_pictures(tmp_path):
    recording = open_hdf5(act(tmp_path / "a.hdf5"))
    assert np.array_equal(recording.pictures("cam_high", [1, 4]), recording.pictures("cam_high")[[1, 4]])


def test_an_unknown_camera_error_lists_the_known_ones(tmp_path):
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


@pytest.mark.parametrize(("channels", "said"), [(1, "grey"), (4, "alpha"), (3, None)])
def test_pictures_other_than_rgb_are_reported(tmp_path, channels, said):
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file["observations/images/top"] = np.zeros((3, HEIGHT, WIDTH, channels), np.uint8)
    recording = open_hdf5(tmp_path / "a.hdf5")
    assert recording.camera("top").channels == channels
    assert [note for note in recording.notes if said and said in note and "top" in note] == recording.notes
    assert bool(recording.notes) == bool(said)


def test_acts_state_is_the_joints_with_names_made_up(tmp_path):
    recording = open_hdf5(act(tmp_path / "a.hdf5"))
    assert recording.state.shape == (FRAMES, 14)
    assert recording.state_names == recording.action_names == [f"joint_{column}" for column in range(14)]
    assert (recording.task, recording.robot, recording.fps) == (None, None, None)


def test_robotwin_commands_stand_for_the_missing_state_with_a_note(tmp_path):
    recording = open_hdf5(robotwin(tmp_path / "a.hdf5"))
    with h5py.File(recording.path) as file:
        assert np.array_equal(recording.state[:, 6], file["joint_action/left_gripper"])
    assert recording.state_names[5:8] == ["left_arm_5", "left_gripper", "right_arm_0"]
    assert len(recording.state_notes) == 1 and "measured" in recording.state_notes[0]


def test_the_command_of_a_robotwin_frame_leads_to_the_next_frame(tmp_path):
    recording = open_hdf5(robotwin(tmp_path / "a.hdf5"))
    state, action = recording.state, recording.motion.values
    assert np.array_equal(action[:-1], state[1:]) and np.array_equal(action[-1], state[-1])
    assert "of the next" in "".join(recording.notes)


def test_a_state_of_robotwins_second_layout_leads_to_the_next_where_there_are_no_commands(tmp_path):
    with h5py.File(robotwin_vision(tmp_path / "a.hdf5"), "r+") as file:
        del file["action"]
        file["state/left_arm"][:] = np.arange(FRAMES * 6).reshape(FRAMES, 6)
    recording = open_hdf5(tmp_path / "a.hdf5")
    assert np.array_equal(recording.motion.values[:-1], recording.state[1:])


def test_robotwins_vector_alone_is_enough(tmp_path):
    with h5py.File(robotwin(tmp_path / "a.hdf5"), "r+") as file:
        del file["joint_action"]
        file["joint_action/vector"] = np.zeros((FRAMES, 14))
    motion = open_hdf5(tmp_path / "a.hdf5").motion
    assert (motion.values.shape, motion.grippers) == ((FRAMES, 14), (6, 13))


def test_robotwins_second_layout_has_a_state_of_its_own(tmp_path):
    recording = open_hdf5(robotwin_vision(tmp_path / "a.hdf5"))
    assert np.array_equal(recording.state, np.ones((FRAMES, 6)))
    assert not recording.motion.values.any()  # its commands lead to the next frame already
    assert recording.state_names[0] == "left_arm_0"


def test_a_recording_without_commands_has_neither_motion_nor_state(tmp_path):
    with h5py.File(act(tmp_path / "a.hdf5"), "r+") as file:
        del file["action"], file["observations/qpos"]
    recording = open_hdf5(tmp_path / "a.hdf5")
    assert (recording.motion, recording.state, recording.state_names, recording.action_names) == (None, None, [], [])


@pytest.mark.parametrize(("key", "what"), [("action", "motion"), ("observations/qpos", "state")])
def test_a_camera_with_other_frames_than_the_robot_is_refused_with_both_numbers(tmp_path, key, what):
    with h5py.File(act(tmp_path / "a.hdf5"), "r+") as file:
        del file[key]
        file[key] = np.zeros((FRAMES - 1, 14))
    with pytest.raises(DamagedFile, match=r"cam_high has 6 pictures, the \w+ 5 rows"):
        getattr(open_hdf5(tmp_path / "a.hdf5"), what)


def test_arms_of_different_lengths_are_refused(tmp_path):
    with h5py.File(robotwin(tmp_path / "a.hdf5"), "r+") as file:
        del file["joint_action/right_gripper"]
        file["joint_action/right_gripper"] = np.zeros(FRAMES + 2)
    with pytest.raises(DamagedFile, match="right_gripper has 8 rows, those before it 6"):
        _ = open_hdf5(tmp_path / "a.hdf5").motion


def test_a_file_that_says_how_its_colours_are_is_believed(tmp_path):
    blue = rooms()[..., ::-1]
    path = robotwin(tmp_path / "a.hdf5", swapped=False, pictures=blue)
    with h5py.File(path, "r+") as file:
        file.attrs["jpeg_colours"] = "true"
    assert np.abs(open_hdf5(path).pictures("head_camera").astype(int) - blue).mean() < 3


def test_a_camera_says_whether_its_colours_are_swapped(tmp_path):
    with h5py.File(robotwin(tmp_path / "a.hdf5"), "r+") as file:
        file["observation/another/rgb"] = rooms()
    recording = open_hdf5(tmp_path / "a.hdf5")
    assert recording.swapped("head_camera") and not recording.swapped("another")
    assert np.array_equal(recording.pictures("another"), rooms())
    with pytest.raises(UnknownName):
        recording.swapped("none")


def test_a_recording_goes_to_another_process_before_and_after_it_was_read(tmp_path):
    recording = open_hdf5(robotwin(tmp_path / "a.hdf5"))
    for _ in range(2):
        again = pickle.loads(pickle.dumps(recording))
        assert np.array_equal(again.pictures("head_camera"), recording.pictures("head_camera"))
        assert np.array_equal(again.motion.values, recording.motion.values)
        assert (again.notes, again.cameras) == (recording.notes, recording.cameras)


def test_a_command_with_nan_is_named(tmp_path):
    with h5py.File(act(tmp_path / "a.hdf5"), "r+") as file:
        file["action"][3, 2] = np.nan
    with pytest.raises(DamagedFile, match="action of frame 3"):
        _ = open_hdf5(tmp_path / "a.hdf5").motion


@pytest.mark.parametrize("commands", [["left"] * FRAMES, 3.0, np.zeros((FRAMES, 2, 2))])
def test_commands_other_than_rows_of_numbers_are_refused(tmp_path, commands):
    with h5py.File(act(tmp_path / "a.hdf5"), "r+") as file:
        del file["action"]
        file["action"] = commands
    with pytest.raises(DamagedFile, match="no row of numbers"):
        _ = open_hdf5(tmp_path / "a.hdf5").motion


def test_commands_of_one_number_and_commands_in_a_group_are_read(tmp_path):
    with h5py.File(act(tmp_path / "a.hdf5"), "r+") as file:
        del file["action"], file["observations/qpos"]
        file["action"] = np.arange(FRAMES)
        file["observations/qpos/left_arm"] = np.zeros((FRAMES, 6))
    recording = open_hdf5(tmp_path / "a.hdf5")
    assert recording.motion.values.shape == (FRAMES, 1)
    assert recording.state_names == [f"left_arm_{joint}" for joint in range(6)]


@pytest.mark.parametrize("nothing", [np.zeros((0, HEIGHT, WIDTH, 3), np.uint8), "a text"])
def test_an_episode_without_frames_is_refused(tmp_path, nothing):
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file["observations/images/top"] = nothing
    with pytest.raises(DamagedFile, match="holds no frame"):
        _ = open_hdf5(tmp_path / "a.hdf5").cameras


@pytest.mark.parametrize(
    ("key", "write"), [("action", act), ("observations/qpos", act), ("action/left_arm", robotwin_vision)]
)
def test_numbers_without_a_row_hold_no_frame(tmp_path, key, write):
    with h5py.File(write(tmp_path / "a.hdf5"), "r+") as file:
        del file[key]
        file[key] = np.zeros((0, 14))
    recording = open_hdf5(tmp_path / "a.hdf5")
    with pytest.raises(DamagedFile, match=rf"{key} holds no frame"):
        _ = recording.motion, recording.state


def test_a_file_that_is_cut_off_is_named(tmp_path):
    path = act(tmp_path / "a.hdf5")
    path.write_bytes(path.read_bytes()[:1000])
    with pytest.raises(DamagedFile, match=r"a\.hdf5 is damaged"):
        open_hdf5(path)


def test_an_unknown_layout_is_refused_with_its_contents(tmp_path):
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file["data/demo_0/thing"] = np.zeros(3)
    with pytest.raises(DamagedFile, match="data/demo_0"):
        open_hdf5(tmp_path / "a.hdf5")
