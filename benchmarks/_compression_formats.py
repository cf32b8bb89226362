"""Formats of clips: single pictures, LeRobot's video, and videos searched for a loss."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Protocol

import av
import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks._compression_clips import Film
from benchmarks._compression_stored import Stored, Video, store_pictures
from vcage.base.videos import decode
from vcage.datasets.packing.settings import CompressionSettings
from vcage.video.choices import Choices, Criterion
from vcage.video.codec import encode
from vcage.video.encoders import CODECS, kept_priority
from vcage.video.jod import JodMetric
from vcage.video.judge import Judge
from vcage.video.search import SearchResult, search_clip

LIMIT = 0.1
"""Loss that every searched format must stay below, JOD."""

SLACK = 1.1
"""Factor on a clip's least loss, for a codec without a lossless form that cannot reach the limit."""

AHEAD = 3
"""So far above the CRF that is known of another GOP the first encoding is."""

TIMED = 40
"""Frames that are encoded to time one."""


@dataclass(frozen=True)
class Made:
    """A clip in one format.

    Args:
        stored: its file.
        encode_ms: CPU time of the encoding that is kept, per frame.
        search_ms: CPU time of the whole search, per frame.
        encodes: encodings in the search, the final one included.
        gop, crf, pixel_format: of a video.
        limit: what the search had to stay below, JOD; None without a search.
    """

    stored: Stored
    encode_ms: float
    search_ms: float
    encodes: int = 1
    gop: int | None = None
    crf: int | None = None
    pixel_format: str | None = None
    limit: float | None = None


@dataclass(frozen=True)
class Found:
    """Result of another format on the same clip: the largest loss of the keyframes, and more as in :class:`Made`."""

    loss: float
    crf: int | None
    pixel_format: str | None


Before = Mapping[str, Found]
"""Results of the earlier formats, by name."""


class Format(Protocol):
    """A way to store a clip."""

    @property
    def name(self) -> str: ...

    def make(self, film: Film, metric: JodMetric, folder: Path, before: Before) -> Made:
        """Store a clip in ``folder``."""


# --- formats without a search --------------------------------------------------------------------------


@dataclass(frozen=True)
class StillPictures:
    """Each frame by itself, by OpenCV, in an HDF5 file.

    RoboTwin keeps JPEG so, and fills all pictures up to the length of the longest; that is not counted here.
    """

    name: str
    extension: str
    options: tuple[int, ...]

    def make(self, film: Film, metric: JodMetric, folder: Path, before: Before) -> Made:
        start = time.process_time()
        stored = store_pictures(film.frames, folder / f"{self.name}.hdf5", self.extension, self.options)
        ms = _ms(start, film)
        return Made(stored, ms, ms)


@dataclass(frozen=True)
class LeRobot:
    """LeRobot's own video, without further options.

    As its ``encode_video_frames`` (https://github.com/huggingface/lerobot) does, the pictures go to PyAV as they are,
    and the colours are converted and tagged as PyAV does by itself.
    """

    name: str = "lerobot-av1-g2-crf30"
    gop: int = 2
    crf: int = 30
    preset: int = 12
    pixel_format: str = "yuv420p"

    def make(self, film: Film, metric: JodMetric, folder: Path, before: Before) -> Made:
        path = folder / f"{self.name}.mp4"
        start = time.process_time()
        self.write(film.frames, film.fps, path)
        ms = _ms(start, film)
        return Made(Video(path), ms, ms, 1, self.gop, self.crf, self.pixel_format)

    def write(self, frames: NDArray[np.uint8], fps: float, path: Path) -> None:
        """Encode (T, H, W, 3) uint8 RGB pictures as a file."""
        os.environ.setdefault("SVT_LOG", "1")  # SVT-AV1 else describes itself on stderr for every file
        options = {"g": self.gop, "crf": self.crf, "preset": self.preset, "svtav1-params": "lp=1"}
        with av.open(str(path), "w") as container:
            rate = Fraction(fps).limit_denominator(1001)
            stream = container.add_stream("libsvtav1", rate, options={k: str(v) for k, v in options.items()})
            stream.pix_fmt = self.pixel_format
            stream.height, stream.width = frames.shape[1:3]
            with kept_priority():
                stream.codec_context.open()
            for picture in frames:
                container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
            container.mux(stream.encode(None))


# --- formats with a search -----------------------------------------------------------------------------


@dataclass(frozen=True)
class Searched:
    """The project's own search, for a codec and GOP; where a codec has no form without loss, without its guard.

    Args:
        name: of the format.
        choices: the options the search may choose from.
        like: a format measured before this one; its loss on the same clip is the limit, in place of :data:`LIMIT`.
        after: a format that must come before, of another GOP; the search keeps its pixel format and begins a little
            above its CRF, which saves encodings.
    """

    name: str
    choices: Choices
    like: str | None = None
    after: str | None = None

    def make(self, film: Film, metric: JodMetric, folder: Path, before: Before) -> Made:
        choices, limit = self._task(film, metric, before)
        criterion = Criterion(limit, guard=self._has_lossless)
        start = time.process_time()
        result = search_clip(Judge(film.frames, film.keyframes, film.fps, criterion, metric), choices)
        search_ms = _ms(start, film)
        path = folder / f"{self.name}.mp4"
        path.write_bytes(result.video)
        return Made(
            Video(path),
            _encode_ms(film, result),
            search_ms,
            len({(trial.pixel_format, trial.gop, trial.crf) for trial in result.trials}),
            result.settings.gop,
            result.crf,
            result.pixel_format,
            limit,
        )

    @property
    def _has_lossless(self) -> bool:
        return bool(self.choices.settings().facts.lossless_format)

    def _task(self, film: Film, metric: JodMetric, before: Before) -> tuple[Choices, float]:
        """Return the choices, and the loss to stay below."""
        if self.like is not None:
            return self.choices, before[self.like].loss
        if not self._has_lossless:
            return self._at_its_best(film, metric)
        known = before[self.after] if self.after is not None else None
        if known is None or known.crf is None or known.pixel_format is None:
            return self.choices, LIMIT
        upper = min(known.crf + AHEAD, self.choices.settings().facts.max_crf)
        return replace(self.choices, pixel_formats=(known.pixel_format,), upper=upper), LIMIT

    def _at_its_best(self, film: Film, metric: JodMetric) -> tuple[Choices, float]:
        """For a codec that may not reach the limit: the pixel format in which it loses least, and a little more."""
        reference, losses = film.frames[film.keyframes], {}
        for name in self.choices.settings().facts.pixel_formats:
            settings = self.choices.settings(name)
            video = encode(film.frames, film.fps, settings, settings.facts.min_crf)
            losses[name] = float(metric.loss(decode(video, film.keyframes), reference).max())
        best = min(losses, key=losses.__getitem__)
        return replace(self.choices, pixel_formats=(best,)), max(LIMIT, SLACK * losses[best])


def _encode_ms(film: Film, result: SearchResult) -> float:
    """CPU time to encode a frame once more as the search found best; a part of the clip is enough to tell."""
    part = film.frames[len(film.frames) // 3 :][:TIMED]
    start = time.process_time()
    encode(part, film.fps, result.settings, result.crf)
    return 1000 * (time.process_time() - start) / len(part)


def _ms(start: float, film: Film) -> float:
    """CPU time since ``start``, milliseconds per frame of the clip."""
    return 1000 * (time.process_time() - start) / len(film.frames)


# --- all of them ---------------------------------------------------------------------------------------

PNG = StillPictures("png", ".png", (cv2.IMWRITE_PNG_COMPRESSION, 6))
JPEG = StillPictures("jpeg-q95-hdf5", ".jpg", (cv2.IMWRITE_JPEG_QUALITY, 95))
LEROBOT = LeRobot()

GOP, SHORT, LONG = 10, 2, 250
"""The project's, LeRobot's, and the encoders' own default."""

DEFAULTS = replace(CompressionSettings().choices(), gops=(GOP,))
"""The project's own choices without options."""

OURS = Searched(f"vcage-g{GOP}", DEFAULTS)
AS_LEROBOT = Searched(
    f"vcage-g{SHORT}-as-lerobot", replace(DEFAULTS, gops=(SHORT,), pixel_formats=("yuv420p10le",)), like=LEROBOT.name
)
RIVALS = tuple(Searched(f"{codec}-g{GOP}", Choices(codec, gops=(GOP,))) for codec in CODECS if codec != DEFAULTS.codec)
OTHER_GOPS = tuple(Searched(f"vcage-g{gop}", replace(DEFAULTS, gops=(gop,)), after=OURS.name) for gop in (SHORT, LONG))


def formats(quick: bool) -> list[Format]:
    """The formats in an order that puts each after its dependencies.

    Args:
        quick: without :data:`OTHER_GOPS`.
    """
    few: list[Format] = [PNG, JPEG, LEROBOT, OURS, AS_LEROBOT, *RIVALS]
    return few if quick else [*few, *OTHER_GOPS]
