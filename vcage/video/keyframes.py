"""Keyframes: the frames on which an encoder is judged (paper, section III-D, "Optimized Keyframe Extraction").

They are the first and last frame, the middle of every opening and closing of a gripper, and the frames where the
command changes fastest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class KeyframeSettings:
    """Choice of keyframes.

    Args:
        count: frames per video, as in the paper; more only where the grippers move more often.
        fewest_peaks: motion peaks that are taken however often the grippers move.
        spread: a motion peak keeps a distance of 1 / (spread · count) of the episode from the other keyframes.
        group_gap_frames: changes of the grippers' commands at most so far apart belong to one opening or closing.
        quaternion_tolerance: of the length from one, as many are stored in single precision.
        largest_angle_rad: a column of commands beyond this is no angle in radians; degrees and percent do not
            repeat after 2π.
        stride_px: of the pixels that show how much pictures change.
        command_tolerance: a smaller change of a gripper's command is rounding.
    """

    count: int = 8
    fewest_peaks: int = 2
    spread: int = 4
    group_gap_frames: int = 5
    quaternion_tolerance: float = 1e-3
    largest_angle_rad: float = 2 * np.pi + 0.1
    stride_px: int = 8
    command_tolerance: float = 1e-6


SETTINGS = KeyframeSettings()


def keyframes(action: NDArray[np.float64], grippers: Sequence[int], count: int = SETTINGS.count) -> list[int]:
    """Return frame indices, increasing, of the most informative moments of an episode.

    Args:
        action: (T, D) commands to one or two arms: joint positions in any unit, or poses of the end-effectors.
        grippers: columns of ``action`` that command a gripper; a constant one marks no moment.
        count: of frames to aim at; fewer when there is too little motion, more when the grippers move often.

    Raises:
        ValueError: ``action`` has no frames.
    """
    if len(action) == 0:
        raise ValueError("action has no frames")
    arms = continuous(np.delete(action, list(grippers), axis=1))
    speed = np.linalg.norm(np.diff(arms, axis=0), axis=1)
    return _chosen(speed, gripper_midpoints(action[:, list(grippers)]), count)


def picture_keyframes(pictures: NDArray[np.uint8], count: int = SETTINGS.count) -> list[int]:
    """Return frames where pictures, (T, H, W, 3) uint8, change fastest, for recordings without commands.

    Raises:
        ValueError: there are no pictures.
    """
    if len(pictures) == 0:
        raise ValueError("there are no pictures")
    small = pictures[:, :: SETTINGS.stride_px, :: SETTINGS.stride_px].astype(np.int16)
    return _chosen(np.abs(np.diff(small, axis=0)).mean(axis=(1, 2, 3)), [], count)


def _chosen(speed: NDArray[np.float64], moments: Sequence[int], count: int) -> list[int]:
    """Return first and last frame, the moments, and the fastest changes apart from those.

    Args:
        speed: (T − 1,) change from each frame to the next.
    """
    frames = len(speed) + 1
    chosen = {0, frames - 1, *moments}
    wanted = max(count - len(chosen), SETTINGS.fewest_peaks)
    apart = max(1, frames // (SETTINGS.spread * count))
    taken = 0
    for peak in motion_peaks(speed):
        if taken == wanted:
            break
        if min(abs(peak - other) for other in chosen) >= apart:
            chosen.add(peak)
            taken += 1
    return sorted(chosen)


def continuous(action: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (T, D) commands without the jumps of their notation.

    q and −q are one rotation, and so are α and α + 2π in columns that may be angles in radians.
    """
    action = action.copy()
    angles = np.abs(action).max(axis=0) <= SETTINGS.largest_angle_rad
    action[:, angles] = np.unwrap(action[:, angles], axis=0)
    for first in _quaternions(action):
        block = action[:, first : first + 4]
        flips = np.where((block[1:] * block[:-1]).sum(axis=1) < 0, -1.0, 1.0)
        block[1:] *= np.cumprod(flips)[:, None]
    return action


def _quaternions(action: NDArray[np.float64]) -> list[int]:
    """Return first columns of four neighbours that have unit length in every frame, and change."""
    found: list[int] = []
    for first in range(action.shape[1] - 3):
        block = action[:, first : first + 4]
        unit = np.abs(np.linalg.norm(block, axis=1) - 1).max() < SETTINGS.quaternion_tolerance
        if unit and np.ptp(block, axis=0).any() and (not found or first >= found[-1] + 4):
            found.append(first)
    return found


def gripper_midpoints(commands: NDArray[np.float64]) -> list[int]:
    """Return the median frame of each group of changes in the (T, G) commands of G grippers."""
    changes = np.flatnonzero((np.abs(np.diff(commands, axis=0)) > SETTINGS.command_tolerance).any(axis=1)) + 1
    if changes.size == 0:
        return []
    groups = np.split(changes, np.flatnonzero(np.diff(changes) > SETTINGS.group_gap_frames) + 1)
    return [int(np.median(group)) for group in groups]


def motion_peaks(speed: NDArray[np.float64]) -> list[int]:
    """Return local maxima of (T − 1,) ‖a(t) − a(t−1)‖₂ as frames t, fastest first; of a plateau its middle."""
    # scipy.signal finds peaks too, but its import takes a second in every process that compresses;
    # zeros around it make a peak of motion at the very start or end
    padded = np.concatenate([[0.0], speed, [0.0]])
    starts = np.concatenate([[0], np.flatnonzero(np.diff(padded)) + 1])
    ends = np.append(starts[1:], len(padded))
    height = padded[starts]
    higher = np.flatnonzero((height[1:-1] > height[:-2]) & (height[1:-1] > height[2:])) + 1
    peaks = (starts[higher] + ends[higher] - 1) // 2
    return [int(peak) for peak in sorted(peaks, key=lambda peak: (-speed[peak - 1], peak))]
