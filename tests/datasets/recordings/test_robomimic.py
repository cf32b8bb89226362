from __future__ import annotations

import json
import pickle

import h5py
import numpy as np
import pytest

from tests.datasets.recordings.layouts import DEMOS, FRAMES, HEIGHT, RATE, WIDTH, robomimic, rooms
from vcage.base.errors import DamagedFile
from vcage.datasets.recordings.opening import open_recordings


@pytest.fixture
def path(tmp_path):
    return robomimic(tmp_path / "lift.hdf5")


def changed(path, key, value=None):
    """The file with another dataset under a key, or none."""
    with h5py.File(path, "r+") as file:
        if key in file:
            del file[key]
        if value is not None:
            file[key] = value
    return path


def test_every_demonstration_is_a_recording_in_the_order_of_their_numbers(path):
    opened = open_recordings(path)
    assert [str(recording) for recording in opened] == [f"{path}:{demo}" for demo in DEMOS]
    assert {recording.LAYOUT for recording in opened} == {"robomimic"}
    assert [recording.motion.values[0, 0] for recording in opened] == [0, 2, 10]


def test_demonstrations_of_several_files_follow_each_other(path):
    robomimic(path.with_name("can.hdf5"), ["demo_1"])
    names = [str(recording).removeprefix(f"{path.parent}/") for recording in open_recordings(path.parent)]
    assert names == ["can.hdf5:demo_1", "lift.hdf5:demo_0", "lift.hdf5:demo_2", "lift.hdf5:demo_10"]


def test_cameras_are_named_without_the_suffix_and_hold_the_demonstrations_own_pictures(path):
    demo = open_recordings(path)[1]
    assert [camera.name for camera in demo.cameras] == ["agentview", "robot0_eye_in_hand"]
    camera = demo.camera("agentview")
    assert camera.key == "data/demo_2/obs/agentview_image"
    assert (camera.frames, camera.width, camera.height, camera.storage) == (FRAMES, WIDTH, HEIGHT, "raw")
    pictures = np.roll(rooms(), 2, axis=2)
    assert np.array_equal(demo.pictures("agentview"), pictures)
    assert np.array_equal(demo.pictures("agentview", [1, 4]), pictures[[1, 4]])


def test_pictures_need_no_suffix_but_depth_is_no_picture(path):
    changed(path, "data/demo_0/obs/agentview_rgb", rooms())
    changed(path, "data/demo_0/obs/agentview_depth", np.zeros((FRAMES, HEIGHT, WIDTH, 1), np.float32))
    names = [camera.name for camera in open_recordings(path)[0].cameras]
    assert names == ["agentview", "agentview_rgb", "robot0_eye_in_hand"]


def test_two_names_that_differ_in_the_suffix_alone_are_two_cameras(path):
    changed(path, "data/demo_0/obs/agentview", rooms())
    names = [camera.name for camera in open_recordings(path)[0].cameras]
    assert names == ["agentview", "agentview_image", "robot0_eye_in_hand"]


def test_the_state_is_the_joints_and_the_gripper_of_every_robot(path):
    changed(path, "data/demo_0/obs/robot1_joint_pos", np.full((FRAMES, 2), 0.25))
    demo = open_recordings(path)[0]
    assert demo.state[0].tolist() == [0.5] * 7 + [0.04] * 2 + [0.25] * 2
    assert demo.state_names[6:10] == [
        "robot0_joint_pos_6",
        "robot0_gripper_qpos_0",
        "robot0_gripper_qpos_1",
        "robot1_joint_pos_0",
    ]


def test_without_joints_there_is_no_state(path):
    for key in ("joint_pos", "gripper_qpos"):
        changed(path, f"data/demo_0/obs/robot0_{key}")
    assert open_recordings(path)[0].state is None


@pytest.mark.parametrize(
    ("numbers", "grippers", "said"),
    [
        (7, (6,), "counted from 0, 6 is taken"),
        (14, (6, 13), "counted from 0, 6, 13 is taken"),
        (8, (), "none is known"),
    ],
)
def test_the_last_of_seven_numbers_of_a_command_moves_a_gripper_and_that_is_reported(path, numbers, grippers, said):
    demo = open_recordings(changed(path, "data/demo_0/actions", np.zeros((FRAMES, numbers))))[0]
    assert demo.motion.grippers == grippers
    assert demo.action_names == [f"action_{number}" for number in range(numbers)]
    assert said in demo.notes[0] and len(demo.motion.notes) == 1


def test_the_frame_rate_is_that_of_the_simulations_control_and_that_is_reported(path):
    demo = open_recordings(path)[0]
    assert demo.fps == RATE
    assert demo.notes[1:] == ["its frame rate is the control_freq of env_args, 20 Hz"]


@pytest.mark.parametrize("told", [None, "no JSON", "[1]", json.dumps({"env_kwargs": {"control_freq": "fast"}})])
def test_without_a_rate_of_control_no_frame_rate_is_reported(path, told):
    with h5py.File(path, "r+") as file:
        del file["data"].attrs["env_args"]
        if told is not None:
            file["data"].attrs["env_args"] = told
    demo = open_recordings(path)[0]
    assert demo.fps is None
    assert not any("frame rate" in note for note in demo.notes)


def test_pictures_of_the_next_step_are_reported_to_stay(path):
    changed(path, "data/demo_0/next_obs/agentview_image", rooms())
    demo = open_recordings(path)[0]
    assert len(demo.cameras) == 2
    assert "next_obs" in demo.notes[1]


def test_a_demonstration_without_pictures_is_named(path):
    for camera in ("agentview", "robot0_eye_in_hand"):
        changed(path, f"data/demo_2/obs/{camera}_image")
    demos = open_recordings(path)
    with pytest.raises(DamagedFile, match=r"lift\.hdf5:demo_2 holds no pictures"):
        _ = demos[1].cameras
    assert len(demos[2].cameras) == 2


def test_a_file_without_any_picture_is_in_no_known_layout(path):
    for demo in DEMOS:
        changed(path, f"data/{demo}/obs")
    with pytest.raises(DamagedFile, match=r"lift\.hdf5 holds no pictures") as refused:
        open_recordings(path)
    assert "robomimic's" in refused.value.hint


def test_a_demonstration_goes_to_another_process(path):
    demo = pickle.loads(pickle.dumps(open_recordings(path)[2]))
    assert str(demo).endswith("demo_10")
    assert len(demo.pictures("agentview")) == FRAMES
