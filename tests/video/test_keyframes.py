"""Keyframes are where grippers move, where arms move fastest, and both ends."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from vcage.video.keyframes import (
    SETTINGS,
    continuous,
    gripper_midpoints,
    keyframes,
    motion_peaks,
    picture_keyframes,
)


def ramp(length: int, start: int, end: int) -> np.ndarray:
    """0, rising from frame ``start`` to 1 at frame ``end``."""
    return np.clip((np.arange(length) - start) / (end - start), 0, 1)


def test_the_midpoint_of_a_slow_closing_is_the_median_of_its_changes():
    assert gripper_midpoints(ramp(100, 20, 30)[:, None]) == [25]


def test_two_closings_apart_are_two_groups():
    command = ramp(100, 20, 30) - ramp(100, 60, 62)
    assert gripper_midpoints(command[:, None]) == [25, 61]


def test_two_arms_have_their_own_events_and_share_simultaneous_ones():
    left = (np.arange(100) >= 30).astype(float)
    right = left + (np.arange(100) >= 70)
    assert gripper_midpoints(np.stack([left, right], axis=1)) == [30, 70]


def test_the_highest_peak_of_motion_comes_first():
    position = np.cumsum(np.exp(-(((np.arange(100) - 20) / 3) ** 2)) + 2 * np.exp(-(((np.arange(100) - 70) / 3) ** 2)))
    assert motion_peaks(np.abs(np.diff(position)))[:2] == [70, 20]


def test_an_episode_gives_ends_gripper_moves_and_peaks():
    time = np.arange(200)
    arm = np.sin(time / 8.0)
    gripper = ramp(200, 50, 54) - ramp(200, 150, 154)
    chosen = keyframes(np.stack([arm, gripper], axis=1), [1])
    assert {0, 199, 52, 152} <= set(chosen)
    assert len(chosen) == 8


def test_a_gripper_that_never_moves_leaves_room_for_peaks_of_motion():
    arm = np.sin(np.arange(200) / 8.0)
    chosen = keyframes(np.stack([arm, np.ones(200)], axis=1), [1])
    assert len(chosen) == 8


def test_peaks_are_taken_even_when_the_grippers_move_often():
    time = np.arange(400)
    gripper = (time // 25 % 2).astype(float)
    arm = np.cumsum(np.exp(-(((time - 112) / 4) ** 2)) + np.exp(-(((time - 213) / 4) ** 2)))
    events = gripper_midpoints(gripper[:, None])
    chosen = keyframes(np.stack([arm, gripper], axis=1), [1])
    assert len(chosen) == 2 + len(events) + SETTINGS.fewest_peaks


def test_an_episode_without_any_motion_has_its_ends():
    assert keyframes(np.zeros((50, 4)), [3]) == [0, 49]


@pytest.mark.parametrize(("frames", "expected"), [(1, [0]), (2, [0, 1])])
def test_the_shortest_episodes(frames, expected):
    assert keyframes(np.zeros((frames, 3)), [2]) == expected


def test_an_empty_episode_is_refused():
    with pytest.raises(ValueError, match="no frames"):
        keyframes(np.zeros((0, 3)), [2])


@given(hnp.arrays(float, st.tuples(st.integers(1, 60), st.just(4)), elements=st.floats(-3, 3, width=16)))
def test_keyframes_are_increasing_frames_of_the_episode(action):
    chosen = keyframes(action, [3])
    assert chosen == sorted(set(chosen))
    assert chosen[0] == 0 and chosen[-1] == len(action) - 1


def turning(frames: int) -> np.ndarray:
    """(T, 4) wxyz of a hand that turns half around z at an even speed."""
    half = np.linspace(0, np.pi / 2, frames)
    return np.stack([np.cos(half), 0 * half, 0 * half, np.sin(half)], axis=1)


def test_a_quaternion_that_changes_its_sign_is_no_motion():
    pose = np.hstack([np.zeros((60, 3)), turning(60), np.ones((60, 1))])
    flipped = pose.copy()
    flipped[30:, 3:7] *= -1
    assert keyframes(flipped, [7]) == keyframes(pose, [7])


def test_an_angle_that_passes_pi_is_no_motion():
    roll = np.linspace(2, 5, 60)
    wrapped = (roll + np.pi) % (2 * np.pi) - np.pi
    assert np.ptp(np.diff(continuous(wrapped[:, None])[:, 0])) < 1e-9


@pytest.mark.parametrize("offset", [0.0, 300.0])
def test_a_fast_motion_in_degrees_or_percent_stays_the_fastest(offset):
    degrees = np.full(60, offset)
    degrees[20:] += 360
    degrees[40:] += 30
    assert {20, 40} <= set(keyframes(degrees[:, None], []))


def test_poses_of_two_arms_are_understood_like_joints():
    swing = np.cumsum(np.exp(-(((np.arange(100) - 40) / 3) ** 2)))[:, None]
    left = np.hstack([swing, np.zeros((100, 2)), turning(100), np.ones((100, 1))])
    right = np.hstack([np.zeros((100, 3)), turning(100), (np.arange(100) >= 70)[:, None]])
    chosen = keyframes(np.hstack([left, right]), [7, 15])
    assert {0, 40, 70, 99} <= set(chosen)


def test_pictures_without_commands_are_scored_where_they_change_fastest():
    pictures = np.zeros((50, 32, 32, 3), np.uint8)
    pictures[20:] = 200
    pictures[35:] = 90
    assert {0, 20, 35, 49} == set(picture_keyframes(pictures))


@pytest.mark.parametrize(("frames", "expected"), [(1, [0]), (2, [0, 1])])
def test_the_shortest_films(frames, expected):
    assert picture_keyframes(np.zeros((frames, 32, 32, 3), np.uint8)) == expected


def test_no_pictures_are_refused():
    with pytest.raises(ValueError, match="no pictures"):
        picture_keyframes(np.zeros((0, 32, 32, 3), np.uint8))
