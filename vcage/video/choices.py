"""Choices of a search, and the criterion that it must pass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vcage.schema.compression import Effort, Reduce
from vcage.video.codec import EncoderSettings

LOSSLESS = -1
"""A CRF below all others: none passes."""


@dataclass(frozen=True)
class Criterion:
    """Condition for a clip to pass.

    Args:
        threshold: upper limit of the loss, JOD.
        reduce: over the scored frames, 'max' or 'mean'.
        guard: true if frames other than keyframes must pass as well.
        most_deciding: frames, those that lose most, that predict the loss of all at other CRFs. Measured on five clips
            of 16 keyframes, between pairs of CRFs at most 4 apart: in 16 % of them the worst frame is another one (12 %
            with five), which loses 5 % more on average; then the whole video decides.
    """

    threshold: float = 0.1
    reduce: Reduce = "max"
    guard: bool = True
    most_deciding: int = 4

    def loss(self, losses: NDArray[np.float64]) -> float:
        """Return one number for the losses of several frames."""
        return float(losses.max() if self.reduce == "max" else losses.mean())

    def deciding(self, frames: Sequence[int], losses: NDArray[np.float64]) -> list[int]:
        """Return the frames among which the worst at other CRFs should be, increasing; all where their mean counts."""
        if self.reduce == "mean":
            return list(frames)
        return sorted(frames[i] for i in np.argsort(-losses, kind="stable")[: self.most_deciding])

    def failing(self, frames: Sequence[int], losses: NDArray[np.float64]) -> list[int]:
        """Return the failing frames where the losses together do not pass."""
        if self.loss(losses) < self.threshold:
            return []
        return [f for f, loss in zip(frames, losses, strict=True) if self.reduce == "mean" or loss >= self.threshold]


@dataclass(frozen=True)
class Choices:
    """Choices of a search; one pixel format and one GOP leave it the CRF alone.

    Args:
        codec: see :class:`EncoderSettings`.
        effort: of the encoder.
        pixel_formats: empty for the codec's default search.
        gops: the first is searched, the others are tried at the CRF that it allows.
        upper: the CRF to encode at, or below it where that loses too much, with the first of the other choices and
            without a search; :data:`LOSSLESS` for none. None searches.
    """

    codec: str = "hevc"
    effort: Effort = "default"
    pixel_formats: tuple[str, ...] = ()
    gops: tuple[int, ...] = (10,)
    upper: int | None = None

    def settings(self, pixel_format: str = "", gop: int = 0) -> EncoderSettings:
        """Return the encoder's settings with one of the choices."""
        return EncoderSettings(self.codec, pixel_format, self.effort, gop or self.gops[0])
