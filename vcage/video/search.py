"""The cheapest encoding of a clip whose loss stays under a threshold (paper, section III-D, "Perception-Driven CRF").

Each trial encodes with the settings of production, decodes as a reader would, and scores decoded keyframes against the
originals; it encodes no more than these take (:mod:`vcage.video.judge`). Many keyframes are encoded alone before, which
only shows where to begin. The paper searches the CRF alone; here the pixel format and the GOP are part of it.

The whole clip is then encoded once, and again only where it fails. The guard scores frames of the whole video that no
search has seen. Those that fail are scored from then on: a search on the failing frames alone finds a lower CRF at
which they pass, and the whole is encoded with it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import UsageError
from vcage.schema.compression import Evaluation, HeldOutLoss
from vcage.video.bisection import steps_to
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
    """Find the encoding of one clip with the fewest bytes whose keyframes pass, regardless of ``choices.upper``.

    The first of the codec's pixel formats and the first GOP are searched for the highest CRF that passes. The others
    are tried at that CRF on the frames that decided, and chosen where these pass with fewer bytes.

    Raises:
        UsageError: the pictures' size fits none of the pixel formats.
        MissingDependency: the encoder is missing.
    """
    height, width = judge.frames.shape[1:3]
    best, *others = formats_for(choices.settings(), width, height, choices.pixel_formats)
    first = choices.settings(best)
    crf, deciding = judge.highest(first, judge.keyframes, first.facts.max_crf, first.facts.first_crf, choices.gops)
    if crf is None:
        return Finding(first, None, first)
    return Finding(_cheapest(judge, choices, first, crf, deciding, others), crf, first)


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
    judge: Judge,
    choices: Choices,
    first: EncoderSettings,
    crf: int,
    deciding: Sequence[int],
    formats: Sequence[str],
    format_saving: float = 0.05,
) -> EncoderSettings:
    """Return the choice of pixel format and GOP with the fewest bytes at which the deciding frames pass.

    A pixel format must save a share of ``format_saving``: with less of the colour, another episode may pass at a much
    lower CRF only. Measured on rendered episodes: it saves 1 to 3 %, and once cost twice the bytes.
    """
    part = judge.part(first, deciding, choices.gops)
    chosen, fewest = first, len(judge.encoded(first, crf, part))

    def passes(settings: EncoderSettings) -> bool:
        return judge.criterion.loss(judge.tried(settings, crf, part, deciding)) < judge.criterion.threshold

    for settings in (choices.settings(first.pixel_format, gop) for gop in choices.gops[1:]):
        size = len(judge.encoded(settings, crf, part))
        if size < fewest and passes(settings):
            chosen, fewest = settings, size
    hopeful = (name for name in reversed(formats) if _hopeful(judge, name))  # to convert costs less than to encode
    for settings in map(choices.settings, hopeful):
        # Where the format with the least colour saves too little, the others save less.
        if len(judge.encoded(settings, crf, part)) >= (1 - format_saving) * fewest:
            break
        if passes(settings):
            return settings
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


@dataclass(frozen=True)
class SearchResult:
    """The result of a search.

    Args:
        settings: the encoder's.
        crf: the highest passing one of the allowed CRFs; None when not even the best quality passes.
        video: the MP4 file at that CRF; of a lossless encoding without one.
        loss_max, loss_mean: of ``video`` over the scored frames, JOD.
        added: frames that the guard added to the keyframes.
        held_out: of ``video``; None when no held-out frame is left.
        trials: all, in order.
    """

    settings: EncoderSettings
    crf: int | None
    video: bytes
    loss_max: float
    loss_mean: float
    added: list[int]
    held_out: HeldOutLoss | None
    trials: list[Evaluation]

    @property
    def pixel_format(self) -> str:
        """Pixel format of ``video``; the lossless form has its own."""
        return self.settings.facts.lossless_format if self.crf is None else self.settings.pixel_format


def search_clip(judge: Judge, choices: Choices) -> SearchResult:
    """Find the encoding of one clip with the fewest bytes that passes, and encode it.

    Raises:
        UsageError: nothing passes and the codec has no lossless form; or see
            :func:`vcage.video.search.find_encoding`.
        MissingDependency: the encoder is missing.
    """
    if choices.upper is None:
        return _Settling(judge, find_encoding(judge, choices)).run()
    settings = choices.settings(choices.pixel_formats[0])
    crf = choices.upper if choices.upper >= settings.facts.min_crf else None
    return _Settling(judge, Finding(settings, crf, settings)).run()


@dataclass
class _Settling:
    judge: Judge
    found: Finding
    added: list[int] = field(default_factory=list)

    def run(self) -> SearchResult:
        settings, crf = self.found.settings, self.found.crf
        while crf is not None:
            look = _Look.at(self.judge, settings, crf, self._scored())
            if not look.failing:
                return self._result(settings, crf, look.scored, look.held_out)
            self.added = sorted({*self.added, *look.failing} - set(self.judge.keyframes))
            lower = self._passing(settings, look.failing, crf - 1, crf + self._steps(look.failing))
            if lower is None and settings != self.found.best:
                settings = self.found.best
                lower = self._passing(settings, look.failing, self.found.crf or 0, self.found.crf or 0)
            crf = lower
        return self._lossless()

    def _scored(self) -> list[int]:
        return sorted({*self.judge.keyframes, *self.added})

    def _steps(self, failing: dict[int, float]) -> int:
        """Return how much lower the CRF must be for the failing frames, at the usual growth of the loss."""
        worst = self.judge.criterion.loss(np.array(list(failing.values())))
        return math.floor(steps_to(self.judge.criterion.threshold, worst))

    def _passing(self, settings: EncoderSettings, failing: dict[int, float], upper: int, first: int) -> int | None:
        """Return the highest CRF at which the worst failing frames pass, or all where their mean counts."""
        criterion = self.judge.criterion
        worst = criterion.deciding(sorted(failing), np.array([failing[frame] for frame in sorted(failing)]))
        return self.judge.highest(settings, worst if criterion.reduce == "max" else self._scored(), upper, first)[0]

    def _lossless(self) -> SearchResult:
        settings = self.found.settings
        require_lossless(self.judge, settings)
        unseen = held_out_frames(len(self.judge.frames), self._scored())
        held_out = HeldOutLoss(worst=0.0, mean=0.0, frame=unseen[0], count=len(unseen)) if unseen else None
        self.judge.losses(self.judge.whole(settings, None), ())  # decodes all of it, to find damage
        return self._result(settings, None, np.zeros(1), held_out)

    def _result(
        self, settings: EncoderSettings, crf: int | None, losses: NDArray[np.float64], held_out: HeldOutLoss | None
    ) -> SearchResult:
        video = self.judge.whole(settings, crf)
        if crf is None:
            self.judge.note(settings, None, losses, video, len(self.judge.frames))
        largest, mean = float(losses.max()), round(float(losses.mean()), 5)
        return SearchResult(settings, crf, video, largest, mean, self.added, held_out, self.judge.trials)


@dataclass(frozen=True)
class _Look:
    """The loss of a whole video.

    Args:
        scored: (N,) in the scored frames, JOD.
        held_out: in frames not seen by any search; None without any.
        failing: frames that do not pass, and their losses.
    """

    scored: NDArray[np.float64]
    held_out: HeldOutLoss | None
    failing: dict[int, float]

    @classmethod
    def at(cls, judge: Judge, settings: EncoderSettings, crf: int, scored: Sequence[int]) -> _Look:
        """Encode a clip as a whole and score it."""
        unseen = held_out_frames(len(judge.frames), scored)
        video = judge.whole(settings, crf)
        frames = sorted({*scored, *unseen})
        losses = dict(zip(frames, judge.losses(video, frames).tolist(), strict=True))
        seen = np.array([losses[frame] for frame in scored])
        judge.note(settings, crf, seen, video, len(judge.frames))
        blamed = judge.criterion.failing(scored, seen)
        held_out = None
        if unseen:
            others = np.array([losses[frame] for frame in unseen])
            worst = int(others.argmax())
            mean = round(float(others.mean()), 5)
            held_out = HeldOutLoss(worst=float(others[worst]), mean=mean, frame=unseen[worst], count=len(unseen))
            if judge.criterion.guard and not blamed:  # else no search found the CRF
                blamed = judge.criterion.failing(unseen, others)
        return cls(seen, held_out, {frame: losses[frame] for frame in blamed})


def held_out_frames(count: int, scored: Sequence[int], step: int = 3, every: int = 10) -> list[int]:
    """Return one of every ten of ``count`` frames, and of the rest at the end, without those in ``scored``.

    Not every tenth: where the GOP is ten frames long, all of them might be intra-coded, which are better than the rest.
    Nor the very first, which is a keyframe in every clip.

    Args:
        count: number of frames.
        scored: the frames judged anyway.
        step: of a held-out frame's place from each ``every`` frames to the next; 3 visits all ten places.
        every: frames with one held-out frame.
    """
    starts = range(0, count, every)
    lengths = (min(every, count - start) for start in starts)
    places = {start + step * (n + 1) % length for n, (start, length) in enumerate(zip(starts, lengths, strict=True))}
    return sorted(places - set(scored))
