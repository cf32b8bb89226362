"""Recordings of simulators on their way to a LeRobot data set: exported parts, omitted parts, and the report."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

from tests.datasets.recordings.layouts import FRAMES, act, robomimic, rooms
from tests.datasets.recordings.simulators import isaac_lab, libero, maniskill, ramp, robotwin_tree, robotwin_v1
from vcage.base.errors import DamagedFile, InputFileError, UsageError
from vcage.datasets.packing.inspecting import as_lines, inspect, totals
from vcage.datasets.packing.output import OutputSpec
from vcage.datasets.packing.pack import Order, Packed, pack, prepare
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.packing.unpacking import unpack_all
from vcage.datasets.recordings.opening import open_recordings
from vcage.video.choices import LOSSLESS

V30 = "lerobot-v3.0"


def order(path: Path, target: str | None = V30, **wanted) -> Order:
    settings = CompressionSettings(crf=LOSSLESS, keyframes=2, effort="fast")
    return Order(path, path.parent / "out", settings, OutputSpec(target, **wanted))


def packed(path: Path, target: str | None = V30, **wanted) -> Packed:
    return pack(order(path, target, **wanted), workers=1)


# --- LIBERO --------------------------------------------------------------------------------------------


def test_a_libero_file_becomes_episodes_with_state_task_and_rate(tmp_path):
    done = packed(libero(tmp_path / "put_the_bowl_demo.hdf5"))
    (episode,) = open_recordings(tmp_path / "out")
    assert (episode.task, episode.fps, episode.frames) == ("put the bowl on the plate", 20, FRAMES)
    assert np.allclose(episode.state, np.concatenate([ramp(7, 10), ramp(2, 20), ramp(6, 30)], axis=1))
    assert episode.state_names[:8:7] == ["joint_states_0", "gripper_states_0"]
    assert np.allclose(episode.motion.values, ramp(7))
    assert set(done.record.left_out) == {
        *("dones", "obs/agentview_depth", "obs/ee_ori", "obs/ee_pos", "rewards", "robot_states", "states")
    }
    assert "depth" in done.record.left_out["obs/agentview_depth"]


@pytest.mark.parametrize(
    ("language", "task"),
    [
        (["put the bowl on the plate"], "put the bowl on the plate"),
        (["put", "the", "bowl", "down"], "put the bowl down"),
        ('"open the  drawer"', "open the drawer"),
        (["open the drawer", "pull the drawer"], "open the drawer"),
        (None, None),
        ([], None),
    ],
)
def test_an_instruction_of_libero_is_a_text_or_a_list(tmp_path, language, task):
    assert open_recordings(libero(tmp_path / "a.hdf5", language))[0].task == task


def test_pictures_that_are_upside_down_stay_so_and_that_is_reported(tmp_path):
    (turned,) = open_recordings(libero(tmp_path / "a.hdf5", convention="opengl"))
    (upright,) = open_recordings(libero(tmp_path / "b.hdf5", convention="opencv"))
    assert any("upside down" in note for note in turned.notes)
    assert not any("upside down" in note for note in upright.notes)
    assert np.array_equal(turned.pictures("agentview_rgb"), rooms())


def test_a_libero_file_stays_whole_as_hdf5(tmp_path):
    path = libero(tmp_path / "a.hdf5")
    done = packed(path, None)
    assert done.record.left_out == {}
    with h5py.File(path) as old, h5py.File(tmp_path / "out/a.hdf5") as new:
        for key in ("states", "obs/agentview_depth", "obs/ee_ori", "rewards"):
            assert np.array_equal(old[f"data/demo_0/{key}"], new[f"data/demo_0/{key}"])
        assert dict(old["data"].attrs) == dict(new["data"].attrs)


# --- Isaac Lab -----------------------------------------------------------------------------------------


def test_a_failed_demonstration_of_isaac_lab_is_left_out_and_counted(tmp_path):
    path = isaac_lab(tmp_path / "stack.hdf5", (True, False, None, True))
    done = packed(path, fps=20, task="stack the cubes")
    episodes = open_recordings(tmp_path / "out")
    assert [episode.motion.values[0, 0] for episode in episodes] == [0, 2, 3]
    assert list(done.record.failed) == ["stack.demo_1"]
    assert np.allclose(episodes[0].state, np.concatenate([ramp(9, 10), ramp(2, 20)], axis=1))
    assert {"initial_state", "obs/datagen_info", "obs/joint_vel", "obs/table_cam_segmentation"} < set(
        done.record.left_out
    )


def test_a_file_of_failures_alone_is_refused_for_lerobot_and_kept_as_hdf5(tmp_path):
    path = isaac_lab(tmp_path / "stack.hdf5", (False, False))
    with pytest.raises(InputFileError, match=r"failed demonstrations only \(2") as refused:
        packed(path, fps=20, task="stack")
    assert "--to hdf5" in refused.value.hint
    done = packed(path, None, fps=20)
    assert list(done.record.failed) == ["stack.demo_0", "stack.demo_1"]
    assert [bool(demo.failed) for demo in open_recordings(tmp_path / "out")] == [True, True]


def test_a_rate_that_isaac_lab_does_not_state_must_be_given(tmp_path):
    with pytest.raises(UsageError, match="does not say how many frames per second") as refused:
        prepare(order(isaac_lab(tmp_path / "a.hdf5"), task="stack"))
    assert "decimation" in refused.value.hint


@pytest.mark.parametrize(
    ("args", "fps"), [({"dt": 0.01, "decimation": 5}, 20), ({"dt": 0.0, "decimation": 1}, None), ({"dt": 0.01}, None)]
)
def test_newer_files_of_isaac_lab_state_their_steps(tmp_path, args, fps):
    (demo,) = open_recordings(isaac_lab(tmp_path / "a.hdf5", args={"sim_args": args}))
    assert demo.fps == fps
    assert any("decimation" in note for note in demo.notes) == (fps is not None)


def test_without_joints_the_pose_of_the_hand_is_the_state(tmp_path):
    path = isaac_lab(tmp_path / "a.hdf5")
    with h5py.File(path, "r+") as file:
        del file["data/demo_0/obs/joint_pos"]
    (demo,) = open_recordings(path)
    assert demo.state.shape == (FRAMES, 9)
    assert demo.state_names[0] == "eef_pos_0"


def test_robomimics_own_failures_are_left_out_too(tmp_path):
    path = robomimic(tmp_path / "lift.hdf5")
    with h5py.File(path, "r+") as file:
        file["data/demo_2"].attrs["success"] = "False"
        file["data/demo_10"]["success"] = np.zeros(FRAMES, bool)
    assert [demo.failed is not None for demo in open_recordings(path)] == [False, True, True]
    assert "mask" in open_recordings(path)[0].left_out()


# --- ManiSkill -----------------------------------------------------------------------------------------


def test_a_trajectory_gives_a_frame_for_each_action(tmp_path):
    path = maniskill(tmp_path / "trajectory.rgb.pd_joint_pos.physx_cpu.h5", kwargs={"sim_config": {"control_freq": 25}})
    done = packed(path)
    (episode,) = open_recordings(tmp_path / "out")
    assert (episode.task, episode.fps, episode.frames) == ("Pick cube", 25, FRAMES)
    assert np.array_equal(episode.pictures("base_camera"), rooms(FRAMES + 1)[:-1])
    assert np.allclose(episode.state, ramp(9, 10)) and np.allclose(episode.motion.values, ramp(8))
    assert {"env_states", "obs/agent/qvel", "obs/extra", "rewards", "success", "the last picture"} < set(
        done.record.left_out
    )
    assert any("after its environment" in note for notes in done.record.notes.values() for note in notes)


def test_a_given_task_counts_more_than_the_name_of_an_environment(tmp_path):
    packed(maniskill(tmp_path / "a.h5"), fps=20, task="pick up the cube")
    assert open_recordings(tmp_path / "out")[0].task == "pick up the cube"


def test_a_trajectory_stays_whole_as_hdf5_beside_its_description(tmp_path):
    path = maniskill(tmp_path / "a.h5")
    packed(path, None, fps=20)
    assert json.loads((tmp_path / "out/a.json").read_text()) == json.loads(path.with_suffix(".json").read_text())
    (recording,) = open_recordings(tmp_path / "out")
    assert np.array_equal(recording.pictures("base_camera"), rooms(FRAMES + 1))
    unpack_all(tmp_path / "out", tmp_path / "back")
    assert [(tmp_path / name / "a.h5").is_file() for name in ("out", "back")] == [True, True]  # the loader wants .h5
    assert (tmp_path / "back/a.json").read_bytes() == path.with_suffix(".json").read_bytes()
    unpack_all(tmp_path / "out", tmp_path / "back", force=True)
    with h5py.File(path) as old, h5py.File(tmp_path / "back/a.h5") as new:
        for key in ("obs/sensor_data/base_camera/rgb", "obs/agent/qpos", "env_states/actors/cube", "success"):
            assert np.array_equal(old[f"traj_0/{key}"], new[f"traj_0/{key}"])


def test_failed_trajectories_are_left_out_and_counted(tmp_path):
    done = packed(maniskill(tmp_path / "a.h5", (False, True, None)), fps=20)
    assert list(done.record.failed) == ["a.traj_0"]
    assert [one.motion.values[0, 0] for one in open_recordings(tmp_path / "out")] == [1, 2]


def test_labels_tell_failures_only_where_some_trajectory_succeeds(tmp_path):
    path = maniskill(tmp_path / "a.h5", (None, None), labels=False)
    assert [one.failed for one in open_recordings(path)] == [None, None]
    assert any("nobody seems to have recorded" in note for note in open_recordings(path)[0].notes)
    with h5py.File(path, "r+") as file:
        file["traj_1/success"][-1] = True
    assert [one.failed for one in open_recordings(path)] == ["its success is false", None]


def test_a_trajectory_without_a_stated_rate_says_where_to_find_it(tmp_path):
    with pytest.raises(UsageError, match="traj_0 does not say how many") as refused:
        prepare(order(maniskill(tmp_path / "a.h5")))
    assert "control_freq" in refused.value.hint


def test_trajectories_without_pictures_are_refused_with_the_command_that_draws_them(tmp_path):
    with pytest.raises(DamagedFile, match="trajectories without pictures") as refused:
        open_recordings(maniskill(tmp_path / "a.h5", pictures=False))
    assert "replay_trajectory" in refused.value.hint
    with h5py.File(tmp_path / "b.h5", "w") as file:
        file["traj_0/actions"], file["traj_0/obs"] = ramp(8), np.zeros((FRAMES + 1, 42))
    with pytest.raises(DamagedFile, match="trajectories without pictures"):
        open_recordings(tmp_path / "b.h5")


def test_a_trajectory_with_as_many_pictures_as_actions_is_refused(tmp_path):
    path = maniskill(tmp_path / "a.h5")
    with h5py.File(path, "r+") as file:
        del file["traj_0/actions"]
        file["traj_0/actions"] = ramp(8)[:-1]
    with pytest.raises(DamagedFile, match="has 7 pictures, the action 5 rows, not 1 fewer"):
        prepare(order(path, fps=20))


def test_a_missing_or_different_description_is_reported(tmp_path):
    path = maniskill(tmp_path / "a.h5")
    told = json.loads(path.with_suffix(".json").read_text())
    told["episodes"][0]["elapsed_steps"] = 9
    path.with_suffix(".json").write_text("\ufeff" + json.dumps(told), encoding="utf-8")
    assert "it has 6 actions, its elapsed_steps are 9" in open_recordings(path)[0].notes
    path.with_suffix(".json").write_text("{")
    with pytest.raises(DamagedFile, match=r"a\.json is not valid JSON"):
        _ = open_recordings(path)[0].fps
    path.with_suffix(".json").unlink()
    assert any("there is no a.json" in note for note in open_recordings(path)[0].notes)


# --- RoboTwin ------------------------------------------------------------------------------------------


def test_instructions_beside_the_data_are_the_tasks(tmp_path):
    done = packed(robotwin_tree(tmp_path / "clean"), fps=16.67)
    episodes = open_recordings(tmp_path / "out")
    assert [episode.task for episode in episodes] == ["Beat block 0", "Beat block 1"]
    targets = ramp(6, 1)
    assert np.allclose(episodes[1].motion.values[:, :6], [*targets[1:], targets[-1]])  # of the next frame
    assert "instructions/unseen" in done.record.left_out
    written = [path for path in (tmp_path / "out").rglob("*") if path.suffix in (".json", ".parquet")]
    assert not any(b"Strike" in path.read_bytes() for path in written)


def test_instructions_are_copied_beside_compressed_files(tmp_path):
    packed(robotwin_tree(tmp_path / "clean", 1), None, fps=15)
    assert [one.task for one in open_recordings(tmp_path / "out")] == ["Beat block 0"]


def test_instructions_outside_the_folder_given_are_read_but_not_copied(tmp_path):
    root = robotwin_tree(tmp_path / "clean", 1)
    done = pack(Order(root / "data", tmp_path / "out", CompressionSettings(crf=20, keyframes=2), OutputSpec(fps=15)))
    assert any("is not copied" in note for note in done.record.notes["episode0"])
    shutil.rmtree(tmp_path / "out")
    packed(root / "data", fps=15)
    assert open_recordings(root / "out")[0].task == "Beat block 0"


@pytest.mark.parametrize("told", ["{", '{"seen": []}', '{"unseen": ["a"]}', "[1]"])
def test_instructions_that_cannot_be_read_are_named(tmp_path, told):
    root = robotwin_tree(tmp_path / "clean", 1)
    (root / "instructions/episode0.json").write_text(told)
    with pytest.raises(DamagedFile, match=r"instructions/episode0\.json"):
        prepare(order(root, fps=15))


def test_a_link_in_the_place_of_instructions_is_not_read(tmp_path):
    root = robotwin_tree(tmp_path / "clean", 1)
    (tmp_path / "secret.json").write_text('["secret"]')
    (root / "instructions/episode0.json").unlink()
    (root / "instructions/episode0.json").symlink_to(tmp_path / "secret.json")
    assert open_recordings(root)[0].task is None


@pytest.mark.parametrize(
    "told", ['["Beat the block", "Hit it"]', '{"seen": ["Beat the block"], "unseen": ["x"]}', "Beat the block"]
)
def test_instructions_in_a_file_of_the_newer_layout_are_the_task(tmp_path, told):
    (episode,) = open_recordings(robotwin_v1(tmp_path / "episode_0000000.hdf5", told))
    assert episode.task == "Beat the block"
    assert episode.fps is None
    assert any("15, counts steps of the simulation" in note for note in episode.notes)
    assert set(episode.left_out()) - {"instructions/unseen"} == {
        *("additional_info", "data_format_version", "vision/cam_head/depths")
    }


# --- all layouts ---------------------------------------------------------------------------------------


def test_unknown_parts_are_named(tmp_path):
    path = act(tmp_path / "a.hdf5")
    with h5py.File(path, "r+") as file:
        file["observations/effort"], file["observations/qvel"] = ramp(14), ramp(14)
        file["strange/one"], file["strange/two"], file["base_action"] = ramp(2), ramp(3), ramp(2)
    found = open_recordings(path)[0].left_out()
    assert set(found) == {"observations/effort", "observations/qvel", "strange", "base_action"}
    assert found["strange"] == "not understood as picture, command or state"
    assert "forces" in found["observations/effort"]


def test_an_inspection_names_the_parts_a_data_set_would_lack(tmp_path):
    found = inspect(isaac_lab(tmp_path / "a.hdf5", (True, False)))
    assert totals(found)["failed"]["count"] == 1
    assert "obs/eef_pos" in totals(found)["left_out"]
    assert "failed: its success is false" in as_lines(found)
    assert as_lines(found).splitlines()[-1].startswith("not for a LeRobot data set: ")


def test_a_redundant_rate_option_is_reported(tmp_path):
    done = packed(libero(tmp_path / "a.hdf5"), fps=30)
    assert any("--fps 30 is not used" in note for note in done.record.notes["a.demo_0"])


def test_a_recording_whose_times_or_instructions_are_damaged_can_be_left_out(tmp_path):
    root = robotwin_tree(tmp_path / "clean", 3)
    (root / "instructions/episode0.json").write_text("{")
    with h5py.File(root / "data/episode2.hdf5", "r+") as file:
        file["timestamps"] = np.arange(FRAMES) / 30
    settings = CompressionSettings(crf=20, keyframes=2)
    wanted = Order(root, tmp_path / "out", settings, OutputSpec(V30, fps=10), skip_damaged=True)
    assert [source.name for source in prepare(wanted).sources.sources] == ["data/episode1"]
    assert set(prepare(wanted).sources.damaged) == {"data/episode0", "data/episode2"}


# --- timestamps in HDF5 --------------------------------------------------------------------------------


def timed(path: Path, values: np.ndarray, fps: float | None = None) -> Path:
    with h5py.File(act(path), "r+") as file:
        file["timestamps"] = values
        if fps is not None:
            file.attrs["fps"] = fps
    return path


@pytest.mark.parametrize(
    "values",
    [
        np.arange(FRAMES) / 50,
        1.7e9 + np.arange(FRAMES) / 50,
        np.arange(FRAMES) * 20,
        (1.7e18 + np.arange(FRAMES) * 2e7).astype(np.int64),
        np.arange(FRAMES) / 50 + [0, 0.001, 0, -0.002, 0, 0],
    ],
)
def test_timestamps_give_the_rate_where_nothing_else_does(tmp_path, values):
    (recording,) = open_recordings(timed(tmp_path / "a.hdf5", values))
    assert (recording.fps, recording.rate_guess) == (None, 50)
    assert "its frame rate is that of timestamps, 50 Hz" in recording.notes
    assert prepare(order(tmp_path / "a.hdf5", task="go")).clips


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (np.arange(FRAMES) / 30, "66.7 ms off, more than half a frame"),
        (np.array([0, 0.02, 0.02, 0.06, 0.08, 0.1]), "does not grow at frame 2"),
        (np.array([0, 0.02, 0.04, 0.01, 0.08, 0.1]), "does not grow at frame 3"),
        (np.array([0, 0.02, 0.04, 0.16, 0.18, 0.2]), "off"),
    ],
)
def test_times_that_contradict_the_stated_rate_do_not_become_a_data_set(tmp_path, values, said):
    path = timed(tmp_path / "a.hdf5", values, 50.0)
    with pytest.raises(DamagedFile, match=said) as refused:
        prepare(order(path, task="go"))
    assert "--to hdf5" in refused.value.hint
    prepare(order(path, "hdf5"))
