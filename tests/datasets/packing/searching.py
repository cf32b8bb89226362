"""A search that takes no time, for tests of who is searched when: the pictures say what passes."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from vcage.datasets.packing import clips
from vcage.schema.compression import Evaluation
from vcage.video.choices import LOSSLESS, Choices
from vcage.video.codec import EncoderSettings
from vcage.video.judge import Judge
from vcage.video.search import Finding
from vcage.video.settling import SearchResult

NONE_PASSES = 255

ALL = "yuv444p10le"
"""The pixel format that is taken where the search may choose."""


def episode(path: Path, size: int = 16, **cameras: int | tuple[int, ...]) -> Path:
    """A file in ACT's layout with square pictures of a size. Each camera's number is the highest CRF that passes in the
    chosen pixel format; a second one is that of all others, a third what the whole video allows where that is less."""
    with h5py.File(path, "w") as file:
        for name, allowed in cameras.items():
            best, *more = allowed if isinstance(allowed, tuple) else (allowed,)
            pictures = np.zeros((2, size, size, 3), np.uint8)
            pictures[..., 0], pictures[..., 1] = best, more[0] if more else best
            pictures[..., 2] = more[1] if more[1:] else NONE_PASSES
            file[f"observations/images/{name}"] = pictures
    return path


class Searches:
    """Stands for both searches, and remembers every call: what was allowed, the choices, and whether it was whole."""

    def __init__(self, patch: pytest.MonkeyPatch):
        self.calls: list[tuple[int, Choices, bool]] = []
        patch.setattr(clips, "find_encoding", self._find)
        patch.setattr(clips, "search_clip", self._search)
        patch.setattr(clips, "_metric", lambda display: None)

    def preferred(self, choices: Choices) -> str:
        """The pixel format that is chosen."""
        return ALL if ALL in (choices.pixel_formats or (ALL,)) else choices.pixel_formats[0]

    def _found(self, judge: Judge, choices: Choices, *, whole: bool) -> tuple[EncoderSettings, int | None]:
        best, other, guarded = judge.frames[0, 0, 0].tolist()
        settings = choices.settings(self.preferred(choices))
        allowed = best if settings.pixel_format == ALL else other
        self.calls.append((best, choices, whole))
        if allowed == NONE_PASSES or choices.highest == LOSSLESS:
            return settings, None
        return settings, min(allowed, choices.highest, guarded if whole else NONE_PASSES)

    def _find(self, judge: Judge, choices: Choices) -> Finding:
        settings, crf = self._found(judge, choices, whole=False)
        return Finding(settings, crf, 0.05, settings, [_trial(settings, crf, 1, 10)])

    def _search(self, judge: Judge, choices: Choices) -> SearchResult:
        settings, crf = self._found(judge, choices, whole=True)
        video = f"{settings.pixel_format} {crf}".encode()
        trial = _trial(settings, crf, len(judge.frames), len(video))
        return SearchResult(settings, crf, video, 0.05, 0.05, [], None, [trial])


def _trial(settings: EncoderSettings, crf: int | None, frames: int, size: int) -> Evaluation:
    return Evaluation(
        pixel_format=settings.pixel_format,
        gop=settings.gop,
        crf=crf,
        loss_max=0.05,
        loss_mean=0.05,
        frames=frames,
        bytes=size,
    )
