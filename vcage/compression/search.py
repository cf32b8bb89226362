"""The highest CRF whose loss stays under a threshold on every keyframe (paper, section III-D, "Perception-Driven CRF").

Each trial encodes the whole clip with the settings of production, decodes it as a reader would, and scores the decoded
keyframes against the originals.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vcage.compression.codec import MAX_CRF, EncoderSettings, encode
from vcage.compression.jod import JodMetric
from vcage.videos import decode

FIRST_GUESS = 18
LOSS_GROWTH = 0.16
"""Growth of ln(loss) per CRF step on rendered clips; it only makes guesses better, never a result."""

FIRST_STEP = 3
"""Smallest step up while nothing has failed yet: a bound above is worth more than a small gain."""

BUDGET = 7
"""Trials at most for one clip."""


@dataclass(frozen=True)
class Trial:
    """One CRF tried on one clip."""

    crf: int
    loss_max: float
    loss_mean: float
    bytes: int


@dataclass(frozen=True)
class SearchResult:
    """What a search found.

    Args:
        crf: the highest CRF that passes; None when not even the best quality does.
        video: the MP4 file at that CRF; of a lossless encoding when there is none.
        loss_max: largest loss of ``video`` over the keyframes, JOD.
        trials: all that was tried, in order.
    """

    crf: int | None
    video: bytes
    loss_max: float
    trials: list[Trial]

    def without_video(self) -> SearchResult:
        """The same result with the video let go."""
        return replace(self, video=b"")


def search_clip(
    frames: NDArray[np.uint8],
    keyframes: Sequence[int],
    fps: float,
    settings: EncoderSettings,
    metric: JodMetric,
    *,
    threshold: float,
    upper: int = MAX_CRF,
) -> SearchResult:
    """Find the highest CRF of one clip, not above ``upper``.

    Args:
        frames: (T, H, W, 3) uint8 RGB.
        keyframes: indices of the frames that are scored, increasing.
        fps: frames per second.
        settings: the encoder's.
        metric: the judge.
        threshold: the largest loss of a keyframe must be below it, JOD.
        upper: the CRF that an earlier clip of the same camera allowed, tried first; -1 when it allowed none.
    """
    reference = frames[list(keyframes)]
    trials: list[Trial] = []
    videos: dict[int, bytes] = {}

    def loss_at(crf: int) -> float:
        videos[crf] = encode(frames, fps, settings, crf)
        losses = metric.loss(decode(videos[crf], keyframes), reference)
        trials.append(Trial(crf, float(losses.max()), round(float(losses.mean()), 5), len(videos[crf])))
        return trials[-1].loss_max

    first = FIRST_GUESS if upper == MAX_CRF else upper
    crf = highest_passing(loss_at, threshold, upper=upper, first=first)
    if crf is None:
        return SearchResult(None, encode(frames, fps, settings, None), 0.0, trials)
    loss_max = next(trial.loss_max for trial in trials if trial.crf == crf)
    return SearchResult(crf, videos[crf], loss_max, trials)


def highest_passing(
    loss_at: Callable[[int], float], threshold: float, *, upper: int = MAX_CRF, first: int = FIRST_GUESS
) -> int | None:
    """The highest CRF in 0 … ``upper`` with ``loss_at(crf) < threshold``, if the loss grows with the CRF.

    A bisection that probes where the last loss says the threshold should be, as far as the budget allows: whatever
    the answer, the CRFs that remain can still be told apart by the trials that remain.

    Args:
        loss_at: the loss at a CRF; called at most :data:`BUDGET` times.
        threshold: what the loss must stay below.
        upper: the highest CRF to consider, at most 51.
        first: the first CRF to try.

    Returns:
        None when the loss at CRF 0 is too large already.
    """
    passes, fails = -1, upper + 1
    guess = first
    for left in reversed(range(BUDGET)):
        if fails - passes == 1:
            break
        room = 2**left
        guess = min(max(guess, fails - room, passes + 1), passes + room, fails - 1)
        loss = loss_at(guess)
        step = math.log(threshold / max(loss, 1e-6)) / LOSS_GROWTH
        if loss < threshold:
            passes = guess
            bounded = fails <= upper
            guess += max(1, math.floor(step)) if bounded else max(FIRST_STEP, math.floor(step) + 1)
        else:
            fails = guess
            guess += min(-1, math.floor(step))
    return passes if passes >= 0 else None
