"""Episodes come about again from their files, bit for bit; what does not is told."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from tests.example_scenes import ON_PLATE, Critic, block_and_plate, robot, scene_of, script_of, setting, subtask
from tests.run_folders import command
from vcage.apps.replay import Difference, compare_pictures, replay_episode
from vcage.base.errors import DamagedFile, DrivesNotRecorded
from vcage.datasets.hdf5 import write_episode
from vcage.datasets.reader import EpisodeReader
from vcage.episodes.runner import versions
from vcage.runs.context import StageContext
from vcage.schema.randomisation import CameraShift, Drawn, Look, WorldDraw
from vcage.sim.looks import draw_look, look_world
from vcage.sim.replay import camera_paths, render_log
from vcage.sim.robots import load_randomisation
from vcage.sim.world import World
from vcage.tasks.assemble import episode_data
from vcage.tasks.loop import EpisodeRun, run_episode

pytestmark = pytest.mark.slow

MODELS = StageContext("offline").physical_models(scene_of(block_and_plate()))


def look(seed: int) -> Look:
    ranges = load_randomisation("full").look
    return draw_look(ranges, scene_of(block_and_plate()), MODELS, robot(), np.random.default_rng(seed))


@pytest.fixture(scope="module")
def context() -> StageContext:
    return StageContext("offline")


def play(critic: Critic, **options: int) -> EpisodeRun:
    """The block onto the plate, in the world that the episode's file describes."""
    objects, step = block_and_plate(), subtask()
    there = replace(setting(objects, {step.id: ON_PLATE}, critic, **options), build=world)
    return run_episode(there, [(step, script_of(step))], 0)


def world() -> World:
    return World.of_scene(scene_of(block_and_plate()), MODELS, robot())


def written(path: Path, run: EpisodeRun) -> Path:
    """An episode's file, of states alone."""
    return write_episode(path, episode_data(run.log, run.segments, {}, facts()), [{}] * len(run.log))


def facts() -> dict[str, object]:
    scene, drawn = scene_of(block_and_plate()), Drawn(ranges="full", look=look(0))
    recorded = scene.model_dump(mode="json", by_alias=True)
    told = {"scene": recorded, "versions": versions(), "randomisation": drawn.model_dump(mode="json")}
    return {"instruction": "blocks", "seed": 0, "robot": scene.robot, **told}


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("plain") / "episode_000000.hdf5", play(Critic()))


@pytest.fixture
def copy(plain: Path, tmp_path: Path) -> Path:
    """One that a test may change."""
    return Path(shutil.copy(plain, tmp_path))


def more_joints(file: h5py.File) -> None:
    file["drives/left/told"].attrs["joints"] = 6


def another_arm(file: h5py.File) -> None:
    file.move("drives/left", "drives/third")


@pytest.mark.parametrize(
    ("change", "told"), [(more_joints, "drives/left/told "), (another_arm, "drives has an arm 'third'")]
)
def test_drives_of_another_robot_are_refused_before_anything_is_simulated(copy, context, change, told):
    with h5py.File(copy, "r+") as file:
        change(file)
    with pytest.raises(DamagedFile, match=told):
        replay_episode(copy, context)


def test_an_episode_comes_about_again_bit_for_bit(plain, context):
    replayed = replay_episode(plain, context)
    assert (replayed.states, replayed.versions, replayed.equal) == (None, {}, True)


def test_an_episode_with_a_retried_sub_task_replays_too(tmp_path, context):
    run = play(Critic([False, True]))
    assert run.segments[0].attempts == 2
    path = written(tmp_path / "retried.hdf5", run)
    with h5py.File(path) as file:
        assert file["drives"].attrs["restarts"].tolist() == [file["drives"].attrs["settled"]]
    assert replay_episode(path, context).equal


def test_a_rejected_episode_replays_too(tmp_path, context):
    run = play(Critic([False]), retries=1)
    assert not run.accepted
    assert replay_episode(written(tmp_path / "rejected.hdf5", run), context).equal


def test_commands_of_failed_attempts_are_not_kept(plain, tmp_path):
    again = written(tmp_path / "retried.hdf5", play(Critic([False, True])))
    with EpisodeReader(plain) as one, EpisodeReader(again) as two:
        once, retried = one.episode.drives, two.episode.drives
    assert once is not None and retried is not None
    assert len(retried) < 1.3 * len(once)


def test_it_takes_less_than_four_kilobytes_for_a_second(plain):
    with h5py.File(plain) as file:
        parts = [part for arm in file["drives"].values() for part in arm.values()]
        assert sum(part.id.get_storage_size() for part in parts) < 4000 * file["timestamp"][-1]


def test_a_changed_command_is_reported_with_its_frame(copy, context):
    with h5py.File(copy, "r+") as file:
        told = file["drives/left/told"]
        step = told.shape[1] // 2
        told[0, step] += 2000
        frame = (step + file["drives"].attrs["settled"]) // 25
    states = replay_episode(copy, context).states
    assert states is not None
    assert states.frame is not None and 0 <= states.frame - frame <= 1
    assert "left_joint" in states.what and states.by


def test_a_changed_state_is_reported_with_its_frame_and_difference(copy, context):
    with h5py.File(copy, "r+") as file:
        file["objects/block"][7, 0] += 0.25
    assert replay_episode(copy, context).states == Difference("the position of block", 7, 0.25)


def test_another_version_is_reported_even_if_all_is_equal(copy, context):
    with h5py.File(copy, "r+") as file:
        file["meta/versions"][()] = json.dumps(versions() | {"sapien": "2.0"})
    replayed = replay_episode(copy, context)
    assert replayed.equal
    assert replayed.versions == {"sapien": ("2.0", versions()["sapien"])}


def test_an_episode_of_an_earlier_version_is_to_be_recorded_again(copy, context):
    with h5py.File(copy, "r+") as file:
        del file["drives"]
    with pytest.raises(DrivesNotRecorded, match="lacks the commands") as error:
        replay_episode(copy, context)
    assert "record the episode again" in error.value.hint


# --- pictures ------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def pictured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One with pictures."""
    run, drawn = play(Critic()), look_world(scene_of(block_and_plate()), MODELS, robot(), look(0))
    log = run.log
    cameras = camera_paths(drawn, log.states())
    data = episode_data(log, run.segments, cameras, facts())
    path = tmp_path_factory.mktemp("pictured") / "episode_000000.hdf5"
    return write_episode(path, data, (frame.pictures for frame in render_log(drawn, log)))


def with_drawn(path: Path, to: Path, drawn: object) -> Path:
    """A copy of a file with other random draws."""
    copied = Path(shutil.copy(path, to))
    with h5py.File(copied, "r+") as file:
        file["meta/randomisation"][()] = json.dumps(drawn)
    return copied


def test_pictures_come_about_again_in_the_look_that_the_file_tells_and_in_no_other(pictured, tmp_path, context):
    assert set(replay_episode(pictured, context).pictures.values()) == {"equal"}
    other = with_drawn(pictured, tmp_path, Drawn(ranges="full", look=look(1)).model_dump(mode="json"))
    found = replay_episode(other, context).pictures
    assert all(isinstance(one, Difference) and one.frame == 0 and one.by for one in found.values())


def test_an_object_of_another_mass_moves_differently(pictured, tmp_path, context):
    drawn = Drawn(ranges="full", look=look(0), world=WorldDraw(mass={"block": 0.5}))
    other = with_drawn(pictured, tmp_path, drawn.model_dump(mode="json"))
    assert replay_episode(other, context).states is not None


def test_a_file_without_its_random_draws_is_reported(plain, tmp_path, context):
    with pytest.raises(DamagedFile, match="looked"):
        replay_episode(with_drawn(plain, tmp_path, {}), context)


def test_unknown_arms_are_reported(plain, tmp_path, context):
    drawn = Drawn(ranges="full", look=look(0), world=WorldDraw(start={"middle": [0.0] * 7}))
    with pytest.raises(DamagedFile, match="no arm 'middle'"):
        replay_episode(with_drawn(plain, tmp_path, drawn.model_dump(mode="json")), context)


@pytest.mark.parametrize(
    ("world", "cameras", "told"),
    [
        ({"mass": {"teapot": 0.5}}, {}, "no object 'teapot'"),
        ({"clutter": {"teapot_beside": "teapot"}}, {}, "no object 'teapot_beside'"),
        ({}, {"cam_low": CameraShift(shift=(0, 0, 0), turn_deg=(0, 0, 0), fovy=1)}, "no camera 'cam_low'"),
    ],
)
def test_draws_for_an_unknown_object_are_reported(plain, tmp_path, context, world, cameras, told):
    seen = look(0).model_copy(update={"cameras": cameras})
    drawn = Drawn(ranges="full", look=seen, world=WorldDraw.model_validate(world))
    with pytest.raises(DamagedFile, match=told):
        replay_episode(with_drawn(plain, tmp_path, drawn.model_dump(mode="json")), context)


def test_a_robot_other_than_the_scenes_is_reported(copy, context):
    with h5py.File(copy, "r+") as file:
        file["meta/robot"][()] = json.dumps("aloha_agilex")
    with pytest.raises(DamagedFile, match="its robot is 'aloha_agilex'"):
        replay_episode(copy, context)


def test_unknown_joints_are_reported(pictured, tmp_path, context):
    path = Path(shutil.copy(pictured, tmp_path))
    with h5py.File(path, "r+") as file:
        fewer = file["robot_joints/left"][:, :5]
        del file["robot_joints/left"]
        file["robot_joints/left"] = fewer
    with pytest.raises(DamagedFile, match="5 joints of left"):
        replay_episode(path, context)


def test_a_camera_at_another_pose_is_reported(pictured, tmp_path, context):
    path = Path(shutil.copy(pictured, tmp_path))
    with h5py.File(path, "r+") as file:
        file["cameras/cam_high/extrinsics"][5:, 0, 3] += 0.5
    found = replay_episode(path, context).pictures["cam_high"]
    assert isinstance(found, Difference) and found.frame == 5 and found.by == pytest.approx(0.5)


def test_a_changed_picture_is_reported_with_its_frame(pictured, tmp_path, context):
    path = Path(shutil.copy(pictured, tmp_path))
    with h5py.File(path, "r+") as file:
        images = file["observations/images/cam_high"]
        picture = images[3]
        picture[0, 0, 0] ^= 1
        images[3] = picture
    found = replay_episode(path, context).pictures
    assert found["cam_high"] == Difference("the picture of cam_high", 3, 1)


def test_the_hash_of_the_recorded_pictures_is_reported_where_a_video_replaced_them(finished):
    path = next(finished.run.root.glob("episodes/*.hdf5"))
    with EpisodeReader(path) as reader:
        assert not any(reader.holds_pictures(camera) for camera in reader.cameras)
        names = reader.cameras
        lossy = zip(*(reader.images(camera) for camera in reader.cameras), strict=True)
        found = compare_pictures(reader, (dict(zip(names, frame, strict=True)) for frame in lossy))
    assert found == {name: Difference(f"the picture of {name}") for name in names}


# --- the command ---------------------------------------------------------------------------------------


def test_the_command_says_that_all_is_equal(plain, capsys):
    answer = command(capsys, "replay", plain)
    assert answer.code == 0, answer.stderr
    assert answer.record["summary"]["episodes"][plain.name]["states"] == "equal"


def test_the_command_ends_with_its_own_code_where_something_differs(copy, capsys):
    with h5py.File(copy, "r+") as file:
        file["objects/block"][7, 0] += 0.25
    answer = command(capsys, "replay", copy)
    assert (answer.code, answer.error["code"]) == (9, "not_reproduced")
    assert "frame 7 on the position of block differs, by 0.25" in answer.error["message"]


def test_all_accepted_episodes_of_a_run_are_replayed(finished, capsys):
    answer = command(capsys, "replay", finished.run.root)
    assert answer.code == 0, answer.stderr
    assert (answer.record["summary"]["equal"], answer.record["summary"]["of"]) == (1, 1)


def test_a_folder_without_episodes_is_named(tmp_path, capsys):
    answer = command(capsys, "replay", tmp_path)
    assert (answer.code, answer.error["code"]) == (3, "missing_stage")
