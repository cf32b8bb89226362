"""The cheapest encoding of a clip whose loss stays under a threshold (paper, section III-D, "Perception-Driven CRF").

Each trial encodes with the settings of production, decodes as a reader would, and scores decoded keyframes against the
originals; it encodes no more than these take (:mod:`vcage.video.excerpt`). The paper searches the CRF alone; here
the pixel format and the GOP are part of it. The result is then encoded as a whole and checked again:
:mod:`vcage.video.settling`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import UsageError
from vcage.video.choices import Choices
from vcage.video.codec import EncoderSettings, formats_for, only_converted
from vcage.video.judge import Judge


@dataclass(frozen=True)
class Finding:
    """The result of a search on excerpts.

    Args:
        settings: the encoder's.
        crf: the highest CRF that passes; None when not even the best quality does.
        best: the settings with the first of the codec's pixel formats, which has its turn where another fails.
    """

    settings: EncoderSettings
    crf: int | None
    best: EncoderSettings


def find_encoding(judge: Judge, choices: Choices) -> Finding:
    """Find the encoding of one clip with the fewest bytes with which its keyframes pass, whatever ``choices.upper``.

    The first of the codec's pixel formats and the first GOP are searched for the highest CRF that passes; the others
    are tried at that CRF, and taken where they pass with fewer bytes.

    Raises:
        UsageError: the pictures' size fits none of the pixel formats.
        MissingDependency: the encoder is missing.
    """
    height, width = judge.frames.shape[1:3]
    best, *others = formats_for(choices.settings(), width, height, choices.pixel_formats)
    first = choices.settings(best)
    crf = judge.highest(first, judge.keyframes, first.facts.max_crf, first.facts.first_crf, choices.gops)
    if crf is None:
        return Finding(first, None, first)
    settings = _cheapest(judge, choices, first, crf, [name for name in others if _hopeful(judge, name)])
    return Finding(settings, crf, first)


def _hopeful(judge: Judge, pixel_format: str, share: float = 0.6) -> bool:
    """True if every scored frame loses less than a share of the threshold in a pixel format without any codec."""
    most, frames = share * judge.criterion.threshold, judge.keyframes
    step = 2 if judge.criterion.reduce == "max" else len(frames)
    parts = (frames[i : i + step] for i in range(0, len(frames), step))
    return all(judge.criterion.loss(_conversion(judge, pixel_format, part)) < most for part in parts)


def _conversion(judge: Judge, pixel_format: str, frames: Sequence[int]) -> NDArray[np.float64]:
    """Return the losses of frames in a pixel format without any codec."""
    return judge.loss(only_converted(judge.frames[list(frames)], pixel_format), frames)


def _cheapest(
    judge: Judge, choices: Choices, first: EncoderSettings, crf: int, formats: Sequence[str]
) -> EncoderSettings:
    """Return the choice of pixel format and GOP with the fewest bytes that passes at the CRF of the first choice."""
    variants = [choices.settings(first.pixel_format, gop) for gop in choices.gops[1:]]
    variants += [choices.settings(name) for name in formats]
    if not variants:
        return first
    part = judge.part(first, judge.keyframes, choices.gops)
    chosen, fewest = first, judge.tried(first, crf, part, judge.keyframes).bytes
    for settings in variants:
        tried = judge.tried(settings, crf, part, judge.keyframes)
        if tried.loss(judge.criterion) < judge.criterion.threshold and tried.bytes < fewest:
            chosen, fewest = settings, tried.bytes
    return chosen


def require_lossless(judge: Judge, settings: EncoderSettings) -> None:
    """Require that a codec can keep every pixel of a clip.

    Raises:
        UsageError: it cannot; states the loss of its colour alone.
    """
    codec = settings.facts
    if codec.lossless_format:
        return
    height, width = judge.frames.shape[1:3]
    names = formats_for(settings, width, height)
    best = min(judge.criterion.loss(_conversion(judge, name, judge.keyframes)) for name in names)
    raise UsageError(
        f"no {codec.name} video stays under {judge.criterion.threshold} JOD: storing colour at half the size "
        f"costs {best:.3f} already, and {codec.name} has no lossless form here",
        hint="take --codec hevc, a larger --max-loss, or a fixed --crf",
    )
