"""The cheapest encoding of a clip whose loss stays under a threshold (paper, section III-D, "Perception-Driven CRF").

Each trial encodes the whole clip with the settings of production, decodes it as a reader would, and scores the decoded
keyframes against the originals. The paper searches the CRF alone; here the pixel format and the GOP are part of it, and
frames that are no keyframes are looked at before a result is believed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import UsageError
from vcage.base.videos import decode
from vcage.schema.compression import Evaluation, HeldOutLoss
from vcage.video.bisection import BUDGET, highest_passing, steps_to
from vcage.video.choices import Choices, Criterion
from vcage.video.codec import EncoderSettings, encode, formats_for, only_converted
from vcage.video.jod import JodMetric

GUARDED = 2
"""Encodings of the budget that other pixel formats and GOPs leave to the guard."""

HOPELESS = 0.6
"""Share of the threshold that a conversion alone may cost in a pixel format that is tried besides the best."""

HELD_OUT_EVERY = 10

WANDER = 3
"""Step of the held-out frame's place from each ten frames to the next; it visits all ten places."""


@dataclass(frozen=True)
class SearchResult:
    """What a search found.

    Args:
        settings: the encoder's.
        crf: the highest CRF that passes, as far as the budget tells; None when not even the best quality does.
        video: the MP4 file at that CRF; of a lossless encoding when there is none.
        loss_max, loss_mean: of ``video`` over the scored frames, JOD.
        added: frames that the guard added to the keyframes.
        held_out: of ``video``; None when no held-out frame is left.
        trials: all that was tried, in order; an encoding appears again where it was scored again on more frames.
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
        """Of ``video``; the lossless form has its own."""
        return self.settings.facts.lossless_format if self.crf is None else self.settings.pixel_format


def search_clip(
    frames: NDArray[np.uint8],
    keyframes: Sequence[int],
    fps: float,
    choices: Choices,
    criterion: Criterion,
    metric: JodMetric,
    threads: int = 0,
) -> SearchResult:
    """Find the encoding of one clip with the fewest bytes that passes.

    The best pixel format and the first GOP are searched for the highest CRF that passes; the others are tried at that
    CRF while the budget lasts, and taken where they pass with fewer bytes. Where held-out frames fail, they join the
    keyframes, and the search goes on below with what is left of the budget; when that is spent, it takes the first CRF
    that passes.

    Args:
        frames: (T, H, W, 3) uint8 RGB.
        keyframes: indices of the frames that are scored, increasing.
        fps: frames per second.
        choices: what there is to choose from.
        criterion: when a clip passes.
        metric: the judge.
        threads: of the encoder; 0 leaves it the choice.

    Raises:
        UsageError: the pictures' size fits none of the pixel formats, or nothing passes and the codec has no lossless
            form.
        MissingDependency: the encoder is missing.
    """
    return _Search(frames, list(keyframes), fps, choices, criterion, metric, threads).run()


@dataclass
class _Search:
    frames: NDArray[np.uint8]
    scored: list[int]
    fps: float
    choices: Choices
    criterion: Criterion
    metric: JodMetric
    threads: int
    added: list[int] = field(default_factory=list)
    trials: list[Evaluation] = field(default_factory=list)
    videos: dict[tuple[EncoderSettings, int], bytes] = field(default_factory=dict)

    def run(self) -> SearchResult:
        best, *others = self._formats() or [""]
        if not best:
            return self._lossless()
        first = self.choices.settings(best)
        facts, highest = first.facts, self.choices.highest
        allowed = self._highest(first, highest, facts.first_crf if highest == facts.max_crf else highest)
        if allowed is None:
            return self._lossless()
        settings, crf = self._cheapest(first, allowed, others), allowed
        while True:
            held_out, failing = self._held_out(settings, crf)
            if held_out is None or not failing or not self.criterion.guard:
                return self._result(settings, crf, held_out)
            self.added += failing
            self.scored = sorted({*self.scored, *failing})
            lower = self._highest(settings, crf - 1, crf + self._steps(held_out))
            if lower is None and settings != first:
                settings, lower = first, self._highest(first, allowed, allowed)
            if lower is None:
                return self._lossless()
            crf = lower

    def _formats(self) -> list[str]:
        """Pixel formats worth a trial, that with the least loss of its own first."""
        names = self._fitting()
        if len(names) == 1:
            return names
        floors = {name: self.criterion.loss(self._conversion(name)) for name in names}
        best, *others = sorted(names, key=lambda name: floors[name])
        if floors[best] >= self.criterion.threshold:
            return []
        return [best, *(name for name in others if floors[name] < HOPELESS * self.criterion.threshold)]

    def _fitting(self) -> list[str]:
        """Pixel formats to choose from that can hold pictures of this size, at least one."""
        height, width = self.frames.shape[1:3]
        return formats_for(self.choices.settings(), width, height, self.choices.pixel_formats)

    def _conversion(self, pixel_format: str) -> NDArray[np.float64]:
        """What the scored frames lose in a pixel format without any codec."""
        reference = self.frames[self.scored]
        return self.metric.loss(only_converted(reference, pixel_format), reference)

    def _highest(self, settings: EncoderSettings, upper: int, first: int) -> int | None:
        """The highest CRF not above ``upper`` that passes on the scored frames, sought from ``first``."""
        return highest_passing(
            lambda crf: self._loss(settings, crf),
            self.criterion.threshold,
            upper,
            first,
            settings.facts.min_crf,
            max(BUDGET - len(self.videos), 0),
        )

    def _steps(self, held_out: HeldOutLoss) -> int:
        """How much lower the CRF must be for held-out frames that failed, if they lose as usual."""
        loss = held_out.worst if self.criterion.reduce == "max" else held_out.mean
        return math.floor(steps_to(self.criterion.threshold, loss))

    def _cheapest(self, settings: EncoderSettings, crf: int, formats: Sequence[str]) -> EncoderSettings:
        """The choice of pixel format and GOP with the fewest bytes that passes at a CRF, as far as the budget goes."""
        for pixel_format, gop in self._variants(settings, formats):
            if len(self.videos) >= BUDGET - GUARDED:
                break
            other = self.choices.settings(pixel_format, gop)
            passes = self._loss(other, crf) < self.criterion.threshold
            if passes and len(self.videos[other, crf]) < len(self.videos[settings, crf]):
                settings = other
        return settings

    def _variants(self, settings: EncoderSettings, formats: Sequence[str]) -> list[tuple[str, int]]:
        return [
            *((settings.pixel_format, gop) for gop in self.choices.gops[1:]),
            *((name, settings.gop) for name in formats),
        ]

    def _loss(self, settings: EncoderSettings, crf: int) -> float:
        """The loss of the scored frames; what was encoded before is scored again, as the guard may have added some."""
        if (settings, crf) not in self.videos:
            self.videos[settings, crf] = encode(self.frames, self.fps, settings, crf, self.threads)
        losses = self._losses(self.videos[settings, crf], self.scored)
        self._note(settings, crf, losses, len(self.videos[settings, crf]))
        return self.criterion.loss(losses)

    def _note(self, settings: EncoderSettings, crf: int | None, losses: NDArray[np.float64], size: int) -> None:
        mean = round(float(losses.mean()), 5)
        name = settings.facts.lossless_format if crf is None else settings.pixel_format
        self.trials.append(
            Evaluation(
                pixel_format=name,
                gop=settings.gop,
                crf=crf,
                loss_max=float(losses.max()),
                loss_mean=mean,
                bytes=size,
            )
        )

    def _losses(self, video: bytes, indices: Sequence[int]) -> NDArray[np.float64]:
        return self.metric.loss(decode(video, indices), self.frames[list(indices)])

    def _held_out(self, settings: EncoderSettings, crf: int) -> tuple[HeldOutLoss | None, list[int]]:
        """What frames lose that were not scored, and those to blame if they do not pass."""
        unseen = held_out_frames(len(self.frames), self.scored)
        if not unseen:
            return None, []
        losses = self._losses(self.videos[settings, crf], unseen)
        worst = int(losses.argmax())
        mean = round(float(losses.mean()), 5)
        held_out = HeldOutLoss(worst=float(losses[worst]), mean=mean, frame=unseen[worst], count=len(unseen))
        return held_out, self.criterion.failing(unseen, losses)

    def _result(self, settings: EncoderSettings, crf: int, held_out: HeldOutLoss | None) -> SearchResult:
        trial = next(
            t
            for t in reversed(self.trials)
            if (t.pixel_format, t.gop, t.crf) == (settings.pixel_format, settings.gop, crf)
        )
        video = self.videos[settings, crf]
        return SearchResult(
            settings, crf, video, trial.loss_max, trial.loss_mean, sorted(self.added), held_out, self.trials
        )

    def _lossless(self) -> SearchResult:
        settings = self.choices.settings()
        self._require_lossless(settings)
        video = encode(self.frames, self.fps, settings, None, self.threads)
        self._note(settings, None, np.zeros(1), len(video))
        unseen = held_out_frames(len(self.frames), self.scored)
        held_out = HeldOutLoss(worst=0.0, mean=0.0, frame=unseen[0], count=len(unseen)) if unseen else None
        return SearchResult(settings, None, video, 0.0, 0.0, sorted(self.added), held_out, self.trials)

    def _require_lossless(self, settings: EncoderSettings) -> None:
        if settings.facts.lossless_format:
            return
        best = min(self.criterion.loss(self._conversion(name)) for name in self._fitting())
        raise UsageError(
            f"no {settings.codec} video stays under {self.criterion.threshold} JOD: storing colour at half the size "
            f"costs {best:.3f} already, and {settings.codec} has no lossless form here",
            hint="take --codec hevc, a larger --max-loss, or a fixed --crf",
        )


def held_out_frames(count: int, scored: Sequence[int], wander: int = WANDER) -> list[int]:
    """One of every ten of ``count`` frames, and of the rest at the end, but for those in ``scored``.

    Not every tenth: where the GOP is ten frames long, all of them might be intra-coded, which are better than the rest.
    Nor the very first, which is a keyframe in every clip.

    Args:
        count: how many frames there are.
        scored: those that are judged anyway.
        wander: step of the place from each ten frames to the next.
    """
    starts = range(0, count, HELD_OUT_EVERY)
    lengths = (min(HELD_OUT_EVERY, count - start) for start in starts)
    places = {start + wander * (n + 1) % length for n, (start, length) in enumerate(zip(starts, lengths, strict=True))}
    return sorted(places - set(scored))
