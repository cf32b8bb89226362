"""Frames in which a robot rests, so that a data set can do without them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vcage.datasets.episode import EpisodeData


@dataclass(frozen=True)
class StillSettings:
    """Limits within which a robot rests.

    Args:
        joint_rad: largest move of the target of a joint, radians.
        gripper: largest move of a gripper's target, and of its measured opening, 0 closed to 1 open.
    """

    joint_rad: float = 1e-3
    gripper: float = 1e-2


STILL = StillSettings()


def moving_frames(episode: EpisodeData, settings: StillSettings = STILL) -> NDArray[np.int64]:
    """(K,) increasing indices of the frames of an episode in which its robot does not rest.

    A frame is still if it leads to where the last frame before it that is not still led: no joint's target and no
    gripper has moved since. So a slow motion is kept, and a gripper that closes while its arm waits. The first frame of
    the episode and of each sub-task, and the last of the episode, always stay.
    """
    reached = np.concatenate([episode.qpos[1:], episode.qpos[-1:]])[:, episode.grippers]
    ends = np.concatenate([episode.action, reached], axis=1)
    limits = np.full(ends.shape[1], settings.gripper)
    limits[[column for column in range(episode.action.shape[1]) if column not in episode.grippers]] = settings.joint_rad
    always = {0, episode.frames - 1, *(segment.start for segment in episode.segments)}
    moving: list[int] = []
    for frame in range(episode.frames):
        if frame in always or (np.abs(ends[frame] - ends[moving[-1]]) > limits).any():
            moving.append(frame)
    return np.array(moving, np.int64)
