"""Excerpts of a video: the frames to encode for the losses of some of its frames.

A closed group of pictures refers to nothing outside it, and where the encoder looks at nothing that comes later, a
frame depends on those before it in its group alone (:attr:`vcage.video.encoders.Codec.causal`). So each group that
holds scored frames is encoded as far as the last of them, one behind the other as a short video of its own, and a
scored frame comes out as it does in the whole video, bit for bit. Other encoders get the whole video.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vcage.video.codec import EncoderSettings, encode
from vcage.video.encoders import Codec


@dataclass(frozen=True)
class Excerpt:
    """Frames of a video to encode as a video of their own.

    Args:
        frames: their indices, increasing.
        starts: places among them at which a group begins.
    """

    frames: tuple[int, ...]
    starts: frozenset[int]

    def encoded(self, pictures: NDArray[np.uint8], fps: float, settings: EncoderSettings, crf: int) -> bytes:
        """Return the excerpt as a video.

        Args:
            pictures: (T, H, W, 3) uint8 RGB, of the whole video.
            fps: frames per second.
            settings: the encoder's, with one of the GOPs for which the excerpt was made.
            crf: constant rate factor.
        """
        return encode(pictures[list(self.frames)], fps, settings, crf, self.starts)

    def places(self, frames: Sequence[int]) -> list[int]:
        """Return the places in the excerpt of frames of the whole video."""
        return [bisect_left(self.frames, frame) for frame in frames]


def excerpt(count: int, scored: Sequence[int], codec: Codec, gops: Sequence[int]) -> Excerpt:
    """Return the excerpt of a video for the losses of some of its frames.

    Args:
        count: frames of the video.
        scored: frames that are scored.
        codec: of the encoder; one that is not causal gets all frames.
        gops: of all encodings, so that all of them encode the same frames.
    """
    if not codec.causal:
        return Excerpt(tuple(range(count)), frozenset())
    longest = math.lcm(*gops)
    lasts = {frame // longest: frame for frame in sorted(scored)}
    groups = [range(group * longest, last + 1) for group, last in lasts.items()]
    frames = tuple(frame for group in groups for frame in group)
    return Excerpt(frames, frozenset(frames.index(group.start) for group in groups))
