"""One clip and its judge: what it loses in an encoding, of the whole or of the groups of pictures that are scored."""

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
    """One clip, and what was tried on it.

    Args:
        frames: (T, H, W, 3) uint8 RGB.
        keyframes: indices of the frames that are scored, increasing.
        fps: frames per second.
        criterion: when the clip passes.
        metric: gives the losses.

    Attributes:
        trials: all that was tried, in order.
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
        """The whole clip as a video, encoded once; a CRF of None is without loss."""
        if (settings, crf) not in self._wholes:
            self._wholes[settings, crf] = encode(self.frames, self.fps, settings, crf)
        return self._wholes[settings, crf]

    def losses(self, video: bytes, frames: Sequence[int]) -> NDArray[np.float64]:
        """(N,) what N increasing frames lose in a whole video, JOD."""
        return self.loss(decode(video, frames), frames)

    def loss(self, pictures: NDArray[np.uint8], frames: Sequence[int]) -> NDArray[np.float64]:
        """(N,) what (N, H, W, 3) pictures lose against N frames, JOD."""
        return self._known.loss(pictures, self.frames[list(frames)])

    def highest(
        self, settings: EncoderSettings, scored: Sequence[int], upper: int, first: int, gops: Sequence[int] = ()
    ) -> int | None:
        """The highest CRF at which some frames pass; None where they do at none.

        The first trial tells which of them decide (:meth:`Criterion.deciding`); the others look at these alone.

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
        """What must be encoded for a score.

        Args:
            settings: the encoder's.
            scored: the frames that are scored, increasing.
            gops: all GOPs that are to be compared, of which each gets the same frames; none for that of the settings.
        """
        return excerpt(len(self.frames), scored, settings.facts, gops or (settings.gop,))

    def tried(self, settings: EncoderSettings, crf: int, part: Excerpt, scored: Sequence[int]) -> Tried:
        """Encode an excerpt, and score frames of it.

        Args:
            settings: the encoder's.
            crf: constant rate factor.
            part: what is encoded.
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
        """Put a trial down.

        Args:
            settings: the encoder's.
            crf: constant rate factor; None is without loss.
            losses: of the frames that were scored, JOD.
            video: what was encoded.
            frames: how many.
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
    """What one trial came to.

    Args:
        losses: (N,) of the scored frames, JOD.
        bytes: of what was encoded.
    """

    losses: NDArray[np.float64]
    bytes: int

    def loss(self, criterion: Criterion) -> float:
        """The one number that counts of the losses."""
        return criterion.loss(self.losses)
