"""Frames in which a robot rests."""

from __future__ import annotations

import numpy as np

from tests.recordings import episode, segment
from vcage.datasets.episode import EpisodeData, actions_of
from vcage.datasets.still_frames import StillSettings, moving_frames

LIMITS = StillSettings(joint_rad=0.01, gripper=0.05)
FRAMES = 10


def moved(*targets: float, column: int = 0, measured: dict[int, float] | None = None) -> EpisodeData:
    """An episode of one sub-task; one number is driven to targets at the frames, and is there but where measured."""
    values = np.zeros((FRAMES, 6))
    values[:, column] = targets
    reached = values.copy()
    for frame, value in (measured or {}).items():
        reached[frame, column] = value
    return episode(FRAMES, action=actions_of(values), qpos=reached, qvel=values, segments=[segment(0, FRAMES)])


def test_frames_that_lead_nowhere_are_still():
    kept = moving_frames(moved(0, 1, 1, 1, 1, 2, 3, 3, 3, 3), LIMITS)
    assert kept.tolist() == [0, 4, 5, 9]  # 0 → 1, 1 → 2, 2 → 3, and the end


def test_a_slow_motion_is_thinned_and_not_lost():
    kept = moving_frames(moved(*np.linspace(0, 0.036, FRAMES)), LIMITS)  # 0.004 rad a frame
    assert kept.tolist() == [0, 3, 6, 9]


def test_a_gripper_that_is_still_closing_is_no_rest():
    waiting = [1, 0, 0, 0, 0, 0, 0, 0, 0, 0]
    assert moving_frames(moved(*waiting, column=2), LIMITS).tolist() == [0, 9]
    closing = moved(*waiting, column=2, measured={1: 0.8, 2: 0.6, 3: 0.4})
    assert moving_frames(closing, LIMITS).tolist() == [0, 1, 2, 3, 9]


def test_the_first_frame_of_each_sub_task_and_the_last_frame_stay():
    still = moved(*[0.0] * FRAMES)
    parts = [segment(0, 4), segment(4, FRAMES, "place-block")]
    assert moving_frames(episode(FRAMES, action=still.action, qpos=still.qpos, segments=parts)).tolist() == [0, 4, 9]
