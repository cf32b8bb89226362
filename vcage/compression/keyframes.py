"""Keyframes: the frames on which an encoder is judged (paper, section III-D, "Optimized Keyframe Extraction").

They are the first and last frame, the middle of every opening and closing of a gripper, and the frames where the
command changes fastest.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.signal import find_peaks

COUNT = 8
"""Frames per video, as in the paper; more only where the grippers move more often."""

FEWEST_PEAKS = 2
"""Motion peaks that are taken however often the grippers move."""

SPREAD = 4
"""A motion peak keeps a distance of 1 / (SPREAD · count) of the episode from the other keyframes."""

GROUP_GAP = 5
"""Changes of the grippers' commands at most this many frames apart belong to one opening or closing."""

COMMAND_TOLERANCE = 1e-6
"""A smaller change of a gripper's command is rounding."""


def keyframes(action: NDArray[np.float64], grippers: Sequence[int], count: int = COUNT) -> list[int]:
    """Frame indices, increasing, of the moments that tell most about an episode.

    Args:
        action: (T, D) commanded joint positions.
        grippers: columns of ``action`` that command a gripper.
        count: how many frames to aim at; fewer when there is too little motion, more when the grippers move often.

    Raises:
        ValueError: ``action`` has no frames.
    """
    frames = len(action)
    if frames == 0:
        raise ValueError("action has no frames")
    chosen = {0, frames - 1, *gripper_midpoints(action[:, list(grippers)])}
    wanted = max(count - len(chosen), FEWEST_PEAKS)
    arms = np.delete(action, list(grippers), axis=1)
    apart = max(1, frames // (SPREAD * count))
    taken = 0
    for peak in motion_peaks(arms):
        if taken == wanted:
            break
        if min(abs(peak - other) for other in chosen) >= apart:
            chosen.add(peak)
            taken += 1
    return sorted(chosen)


def gripper_midpoints(commands: NDArray[np.float64]) -> list[int]:
    """The median frame of each group of changes in the (T, G) commands of G grippers."""
    changes = np.flatnonzero((np.abs(np.diff(commands, axis=0)) > COMMAND_TOLERANCE).any(axis=1)) + 1
    if changes.size == 0:
        return []
    groups = np.split(changes, np.flatnonzero(np.diff(changes) > GROUP_GAP) + 1)
    return [int(np.median(group)) for group in groups]


def motion_peaks(action: NDArray[np.float64]) -> list[int]:
    """Local maxima of ‖a(t) − a(t−1)‖₂, fastest first; of a plateau its middle."""
    speed = np.linalg.norm(np.diff(action, axis=0), axis=1)
    # zeros around it make a peak of motion that begins at once or lasts to the end
    peaks, _ = find_peaks(np.concatenate([[0.0], speed, [0.0]]))
    return [int(peak) for peak in sorted(peaks, key=lambda peak: (-speed[peak - 1], peak))]
