"""From a recording to the arrays that are stored."""

from __future__ import annotations

import json

import numpy as np
import pytest

from tests.example_scenes import Critic, play_once, robot
from vcage.base.geometry import Camera, Pose
from vcage.datasets.episode import EpisodeData
from vcage.tasks.assemble import episode_data
from vcage.tasks.loop import EpisodeRun


@pytest.fixture(scope="module")
def run() -> EpisodeRun:
    return play_once(Critic())


@pytest.fixture(scope="module")
def data(run: EpisodeRun) -> EpisodeData:
    path = [Camera(8, 6, 1.0, Pose([0, 0, 1 + 0.01 * i])) for i in range(len(run.log))]
    return episode_data(run.log, run.segments, {"cam": path}, {"instruction": "blocks", "seed": 3})


def test_the_columns_are_named_by_arm_with_the_gripper_last(data: EpisodeData):
    joints = [f"joint_{i}" for i in range(1, 1 + len(robot().arms["left"].joints))]
    one_arm = [*joints, "gripper"]
    assert data.state_names == [f"{arm}_{column}" for arm in ("left", "right") for column in one_arm]


def test_states_velocities_and_actions_have_a_row_per_frame(data: EpisodeData, run: EpisodeRun):
    shape = (len(run.log), len(data.state_names))
    assert data.qpos.shape == data.qvel.shape == data.action.shape == shape


def test_an_action_is_what_was_commanded_when_the_next_frame_was_measured(data: EpisodeData, run: EpisodeRun):
    half, commands = len(data.state_names) // 2, run.log.arm_array("right", "command")
    np.testing.assert_array_equal(data.qpos[:, :half], run.log.arm_array("left", "state"))
    np.testing.assert_array_equal(data.action[:-1, half:], commands[1:])
    np.testing.assert_array_equal(data.action[-1, half:], commands[-1])
    np.testing.assert_allclose(commands[0], data.qpos[0, half:], atol=1e-6)


def test_frames_are_evenly_spaced_from_zero(data: EpisodeData):
    np.testing.assert_allclose(data.timestamp, np.arange(data.frames) / 10)


def test_the_poses_of_all_objects_are_kept(data: EpisodeData, run: EpisodeRun):
    assert sorted(data.object_poses) == ["block", "plate"]
    np.testing.assert_array_equal(data.object_poses["block"][-1, :3], run.log.frames[-1].objects["block"].p)


def test_the_block_ends_higher_than_it_began(data: EpisodeData):
    heights = data.object_poses["block"][:, 2]
    assert heights[-1] > heights[0] + 0.004
    assert heights.max() > heights[0] + 0.03


def test_a_camera_has_its_place_in_every_frame(data: EpisodeData):
    track = data.cameras["cam"]
    assert (track.width, track.height) == (8, 6)
    assert track.extrinsics.shape == (data.frames, 4, 4)


def test_an_episode_without_pictures_has_no_cameras(run: EpisodeRun):
    assert episode_data(run.log, run.segments, {}, {}).cameras == {}


def test_the_segments_and_facts_travel_with_it(data: EpisodeData, run: EpisodeRun):
    assert data.segments == run.segments
    assert json.loads(json.dumps(data.meta)) == {"instruction": "blocks", "seed": 3}
