"""The judge of one clip: its losses in an encoding of the whole or of the scored groups of pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vcage.base.videos import decode
from vcage.schema.compression import Evaluation
from vcage.video.bisection import highest_passing
from vcage.video.choices import Criterion
from vcage.video.codec import EncoderSettings, encode
from vcage.video.excerpt import Excerpt, excerpt
from vcage.video.jod import JodMetric
from vcage.video.known_losses import KnownLosses


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
    _wholes: dict[tuple[EncoderSettings, int | None], bytes] = field(default_factory=dict)
    _known: KnownLosses = field(init=False)

    def __post_init__(self) -> None:
        self._known = KnownLosses(self.metric)

    def whole(self, settings: EncoderSettings, crf: int | None) -> bytes:
        """Return the whole clip as a video, encoded once; a CRF of None is without loss."""
        if (settings, crf) not in self._wholes:
            self._wholes[settings, crf] = encode(self.frames, self.fps, settings, crf)
        return self._wholes[settings, crf]

    def losses(self, video: bytes, frames: Sequence[int]) -> NDArray[np.float64]:
        """Return (N,) losses of N increasing frames in a whole video, JOD."""
        return self.loss(decode(video, frames), frames)

    def loss(self, pictures: NDArray[np.uint8], frames: Sequence[int]) -> NDArray[np.float64]:
        """Return (N,) losses of (N, H, W, 3) pictures against N frames, JOD."""
        return self._known.loss(pictures, self.frames[list(frames)])

    def highest(
        self, settings: EncoderSettings, scored: Sequence[int], upper: int, first: int, gops: Sequence[int] = ()
    ) -> int | None:
        """Return the highest CRF at which some frames pass; None where they pass at none.

        The first trial shows which of them decide (:meth:`Criterion.deciding`); the others score these alone.

        Args:
            settings: the encoder's.
            scored: the frames, increasing.
            upper: the highest CRF to consider.
            first: the first to try.
            gops: see :meth:`part`.
        """
        deciding = list(scored)

        def loss_at(crf: int) -> float:
            nonlocal deciding
            tried = self.tried(settings, crf, self.part(settings, deciding, gops), deciding)
            deciding = self.criterion.deciding(deciding, tried.losses)
            return tried.loss(self.criterion)

        return highest_passing(loss_at, self.criterion.threshold, upper, first, settings.facts.min_crf)

    def part(self, settings: EncoderSettings, scored: Sequence[int], gops: Sequence[int] = ()) -> Excerpt:
        """Return the excerpt to encode for a score.

        Args:
            settings: the encoder's.
            scored: the frames that are scored, increasing.
            gops: all GOPs to compare with the same frames; empty for that of the settings.
        """
        return excerpt(len(self.frames), scored, settings.facts, gops or (settings.gop,))

    def tried(self, settings: EncoderSettings, crf: int, part: Excerpt, scored: Sequence[int]) -> Tried:
        """Encode an excerpt, and score frames of it.

        Args:
            settings: the encoder's.
            crf: constant rate factor.
            part: to be encoded.
            scored: frames of the clip that it holds, increasing.
        """
        if len(part.frames) == len(self.frames):
            video, places = self.whole(settings, crf), list(scored)
        else:
            video, places = part.encoded(self.frames, self.fps, settings, crf), part.places(scored)
        losses = self.loss(decode(video, places), scored)
        self.note(settings, crf, losses, video, len(part.frames))
        return Tried(losses, len(video))

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


@dataclass(frozen=True)
class Tried:
    """The result of one trial.

    Args:
        losses: (N,) of the scored frames, JOD.
        bytes: of the encoding.
    """

    losses: NDArray[np.float64]
    bytes: int

    def loss(self, criterion: Criterion) -> float:
        """Return one number for the losses."""
        return criterion.loss(self.losses)
