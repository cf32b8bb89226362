"""An episode in memory refuses what a training run should never see."""

from __future__ import annotations

import numpy as np
import pytest

from tests.recordings import CAMERAS, FPS, episode, segment
from vcage.datasets.episode import CameraTrack
from vcage.sim.drives import DriveLayout, DriveLog
from vcage.sim.world import PHYSICS_HZ


def test_an_episode_knows_its_length_and_its_grippers():
    data = episode(30)
    assert data.frames == 30
    assert data.grippers == [2, 5]


def test_nan_in_the_action_is_refused_by_name_and_index():
    action = episode().action
    action[4, 1] = np.nan
    with pytest.raises(ValueError, match=r"action holds NaN.*\[4, 1\]"):
        episode(action=action)


def test_a_number_that_float32_cannot_hold_is_refused_by_name_and_index():
    action = episode().action
    action[4, 1] = 1e39
    with pytest.raises(ValueError, match=r"action holds 1e\+39 at index \[4, 1\], which float32 cannot hold"):
        episode(action=action)


@pytest.mark.parametrize(("column", "value"), [(0, 1e300), (3, 0.5)])
def test_a_pose_that_cannot_be_drawn_is_refused(column, value):
    poses = np.tile([0.0, 0.0, 0.8, 1.0, 0.0, 0.0, 0.0], (30, 1))
    episode(object_poses={"block": poses})
    poses[9, column] = value
    with pytest.raises(ValueError, match=r"object_poses\[block\] holds"):
        episode(object_poses={"block": poses})


def test_drives_last_no_longer_than_the_frames():
    def drives(steps: int) -> DriveLog:
        return DriveLog(0, [], {"left": DriveLayout(1, 1)}, {"left": [np.zeros(4)] * steps})

    most = int(31 * PHYSICS_HZ // FPS)
    episode(drives=drives(most))
    with pytest.raises(ValueError, match=f"drives has {most + 1} steps, the 30 frames last at most {most}"):
        episode(drives=drives(most + 1))


@pytest.mark.parametrize("name", ["qpos", "qvel", "action"])
def test_a_state_of_another_length_is_refused(name):
    with pytest.raises(ValueError, match=rf"{name} has the shape \(29, 6\), expected \(30, 6\)"):
        episode(**{name: getattr(episode(), name)[:-1]})


def test_uneven_timestamps_are_refused():
    timestamp = episode().timestamp
    timestamp[10:] += 0.02
    with pytest.raises(ValueError, match=r"timestamp\[10\]"):
        episode(timestamp=timestamp)


def test_timestamps_of_another_rate_are_refused():
    with pytest.raises(ValueError, match="timestamp"):
        episode(fps=12.5)


def test_object_poses_and_cameras_are_checked():
    with pytest.raises(ValueError, match=r"object_poses\[block\]"):
        episode(object_poses={"block": np.zeros((30, 6))})
    track = CameraTrack(64, 48, np.eye(3), np.zeros((3, 4, 4)))
    with pytest.raises(ValueError, match=r"cameras\[cam_high\].extrinsics"):
        episode(cameras={CAMERAS[0]: track})


@pytest.mark.parametrize("ranges", [[(0, 31)], [(5, 5)], [(0, 10), (9, 20)]])
def test_sub_tasks_outside_empty_or_overlapping_are_refused(ranges):
    with pytest.raises(ValueError, match="segments"):
        episode(segments=[segment(*pair) for pair in ranges])


def test_an_episode_of_one_frame_is_legal():
    assert episode(1).frames == 1
