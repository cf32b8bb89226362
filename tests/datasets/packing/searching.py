"""A search that takes no time, for tests of who is searched when: the pictures say what passes."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from vcage.datasets.packing import clips
from vcage.schema.compression import Evaluation
from vcage.video.choices import LOSSLESS, Choices
from vcage.video.judge import Judge
from vcage.video.search import SearchResult

NONE_PASSES = 255

ALL = "yuv444p10le"
"""The pixel format that is taken where the search may choose."""


def episode(path: Path, size: int = 16, frames: int = 2, **cameras: int | tuple[int, int]) -> Path:
    """A file in ACT's layout with square pictures of a size. Each camera's number is the highest CRF that passes in the
    chosen pixel format; a second one is that of all others."""
    with h5py.File(path, "w") as file:
        for name, allowed in cameras.items():
            best, other = allowed if isinstance(allowed, tuple) else (allowed, allowed)
            pictures = np.zeros((frames, size, size, 3), np.uint8)
            pictures[..., 0], pictures[..., 1] = best, other
            file[f"observations/images/{name}"] = pictures
    return path


class Searches:
    """Stands for the search of a clip, and remembers every call: what was allowed, and the choices."""

    def __init__(self, patch: pytest.MonkeyPatch):
        self.calls: list[tuple[int, Choices]] = []
        patch.setattr(clips, "search_clip", self._search)
        patch.setattr(clips, "_metric", lambda display: None)

    def preferred(self, choices: Choices) -> str:
        """The pixel format that is chosen."""
        return ALL if ALL in (choices.pixel_formats or (ALL,)) else choices.pixel_formats[0]

    def _search(self, judge: Judge, choices: Choices) -> SearchResult:
        best, other, _ = judge.frames[0, 0, 0].tolist()
        settings = choices.settings(self.preferred(choices))
        allowed = best if settings.pixel_format == ALL else other
        self.calls.append((best, choices))
        upper = allowed if choices.upper is None else choices.upper
        crf = None if allowed == NONE_PASSES or upper == LOSSLESS else min(allowed, upper)
        video = f"{settings.pixel_format} {crf}".encode()
        trial = Evaluation(
            pixel_format=settings.pixel_format,
            gop=settings.gop,
            crf=crf,
            loss_max=0.05,
            loss_mean=0.05,
            frames=len(judge.frames),
            bytes=len(video),
        )
        return SearchResult(settings, crf, video, 0.05, 0.05, [], None, [trial])
