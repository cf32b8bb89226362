"""The judge of one clip: its losses in an encoding of the whole or of the scored groups of pictures."""

from __future__ import annotations

import hashlib
import math
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile
from vcage.base.videos import decode, decode_whole
from vcage.schema.compression import Evaluation
from vcage.video.bisection import highest_passing, steps_to
from vcage.video.choices import Criterion
from vcage.video.codec import EncoderSettings, encode
from vcage.video.encoders import Codec
from vcage.video.jod import JodMetric


@dataclass(frozen=True)
class RankingSettings:
    """Frames encoded alone, to see which lose most before any group of pictures is encoded.

    Measured on nine clips of 178 frames at CRF 16, HEVC: the worst of 19 keyframes is among the four that lose most
    alone in seven clips, and loses 1 and 14 % more than these in two; then the whole video decides.

    Args:
        share: loss of the worst frame alone, of that in its group: the median; all are between 0.52 and 0.62.
        cost: time to encode a frame alone, in those of a frame of a group.
    """

    share: float = 0.58
    cost: float = 2.2


RANKING = RankingSettings()


@dataclass
class KnownLosses:
    """A metric that compares a picture with a reference once; a loss depends on their pixels alone.

    Args:
        metric: of new pairs.
    """

    metric: JodMetric
    _losses: dict[bytes, float] = field(default_factory=dict, init=False)

    def loss(self, test: NDArray[np.uint8], reference: NDArray[np.uint8]) -> NDArray[np.float64]:
        """Return the loss of each of N pictures against its reference, see :meth:`vcage.video.jod.JodMetric.loss`."""
        keys = [_hash(*pair) for pair in zip(test, reference, strict=True)]
        new = {key: index for index, key in enumerate(keys) if key not in self._losses}
        if new:
            places = list(new.values())
            self._losses |= zip(new, self.metric.loss(test[places], reference[places]).tolist(), strict=True)
        return np.array([self._losses[key] for key in keys])


def _hash(test: NDArray[np.uint8], reference: NDArray[np.uint8]) -> bytes:
    return hashlib.blake2b(test.tobytes() + reference.tobytes(), digest_size=16).digest()


@dataclass(frozen=True)
class Excerpt:
    """Frames of a video to encode as a video of their own.

    Args:
        frames: their indices, increasing.
        starts: places among them at which a group begins.
    """

    frames: tuple[int, ...]
    starts: frozenset[int]


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


@dataclass
class Judge:
    """One clip, and the trials on it.

    Args:
        frames: (T, H, W, 3) uint8 RGB.
        keyframes: indices of the frames that are scored, increasing.
        fps: frames per second.
        criterion: for the clip to pass.
        metric: of the losses.

    Attributes:
        trials: in order.
    """

    frames: NDArray[np.uint8]
    keyframes: Sequence[int]
    fps: float
    criterion: Criterion
    metric: JodMetric
    trials: list[Evaluation] = field(default_factory=list)
    _videos: dict[tuple[EncoderSettings, int | None, tuple[int, ...]], bytes] = field(default_factory=dict)
    _known: KnownLosses = field(init=False)

    def __post_init__(self) -> None:
        self._known = KnownLosses(self.metric)

    def whole(self, settings: EncoderSettings, crf: int | None) -> bytes:
        """Return the whole clip as a video, encoded once; a CRF of None is without loss."""
        return self.encoded(settings, crf, Excerpt(tuple(range(len(self.frames))), frozenset()))

    def encoded(self, settings: EncoderSettings, crf: int | None, part: Excerpt) -> bytes:
        """Return an excerpt as a video, encoded once."""
        key = (settings, crf, part.frames)
        if key not in self._videos:
            whole = len(part.frames) == len(self.frames)
            frames, starts = (self.frames, ()) if whole else (self.frames[list(part.frames)], part.starts)
            self._videos[key] = encode(frames, self.fps, settings, crf, starts)
        return self._videos[key]

    def losses(self, video: bytes, frames: Sequence[int]) -> NDArray[np.float64]:
        """Return (N,) losses of N increasing frames in a whole video, JOD.

        Raises:
            DamagedFile: one of its frames cannot be decoded, or is missing.
        """
        pictures, count = decode_whole(video, frames)
        if count != len(self.frames):
            raise DamagedFile(f"an encoded video holds {count} of {len(self.frames)} frames")
        return self.loss(pictures, frames)

    def loss(self, pictures: NDArray[np.uint8], frames: Sequence[int]) -> NDArray[np.float64]:
        """Return (N,) losses of (N, H, W, 3) pictures against N frames, JOD."""
        return self._known.loss(pictures, self.frames[list(frames)])

    def highest(
        self, settings: EncoderSettings, scored: Sequence[int], upper: int, first: int, gops: Sequence[int] = ()
    ) -> tuple[int | None, list[int]]:
        """Return the highest CRF at which some frames pass, None where they pass at none; and those that decide.

        Many frames are first encoded alone (:meth:`_ranked`). The first trial of a few shows which of them decide
        (:meth:`Criterion.deciding`); the others score these alone.

        Args:
            settings: the encoder's.
            scored: the frames, increasing.
            upper: the highest CRF to consider.
            first: the first to try.
            gops: see :meth:`part`.
        """
        deciding, first = self._ranked(settings, scored, first, gops)

        def loss_at(crf: int) -> float:
            nonlocal deciding
            losses = self.tried(settings, crf, self.part(settings, deciding, gops), deciding)
            deciding = self.criterion.deciding(deciding, losses)
            return self.criterion.loss(losses)

        return highest_passing(loss_at, self.criterion.threshold, upper, first, settings.facts.min_crf), deciding

    def _ranked(
        self, settings: EncoderSettings, scored: Sequence[int], first: int, gops: Sequence[int]
    ) -> tuple[list[int], int]:
        """Return the frames to try, and the first CRF: by the losses of the frames alone where that takes less time.

        Args: as of :meth:`highest`.
        """
        few = self.criterion.deciding(scored, np.zeros(len(scored)))
        length = len(self.part(settings, scored, gops).frames)
        if len(few) == len(scored) or not settings.facts.causal or RANKING.cost * len(scored) >= length:
            return list(scored), first
        alone = replace(settings, gop=1)
        losses = self.tried(alone, first, self.part(alone, scored), scored)
        in_groups = self.criterion.loss(losses) / RANKING.share
        guess = first + math.floor(steps_to(self.criterion.threshold, in_groups))
        return self.criterion.deciding(scored, losses), guess

    def part(self, settings: EncoderSettings, scored: Sequence[int], gops: Sequence[int] = ()) -> Excerpt:
        """Return the excerpt to encode for a score.

        Args:
            settings: the encoder's.
            scored: the frames that are scored, increasing.
            gops: all GOPs to compare with the same frames; empty for that of the settings.
        """
        return excerpt(len(self.frames), scored, settings.facts, gops or (settings.gop,))

    def tried(self, settings: EncoderSettings, crf: int, part: Excerpt, scored: Sequence[int]) -> NDArray[np.float64]:
        """Return (N,) losses in an encoded excerpt, JOD.

        Args:
            settings: the encoder's.
            crf: constant rate factor.
            part: to be encoded.
            scored: N frames of the clip that it holds, increasing.
        """
        video = self.encoded(settings, crf, part)
        losses = self.loss(decode(video, [bisect_left(part.frames, frame) for frame in scored]), scored)
        self.note(settings, crf, losses, video, len(part.frames))
        return losses

    def note(
        self, settings: EncoderSettings, crf: int | None, losses: NDArray[np.float64], video: bytes, frames: int
    ) -> None:
        """Record a trial.

        Args:
            settings: the encoder's.
            crf: constant rate factor; None is without loss.
            losses: of the scored frames, JOD.
            video: the encoding.
            frames: number of encoded frames.
        """
        self.trials.append(
            Evaluation(
                pixel_format=settings.facts.lossless_format if crf is None else settings.pixel_format,
                gop=settings.gop,
                crf=crf,
                loss_max=float(losses.max()),
                loss_mean=round(float(losses.mean()), 5),
                frames=frames,
                bytes=len(video),
            )
        )
