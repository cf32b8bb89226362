"""One camera of one recording: its search, its video, and the record that an interrupted call leaves."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile
from vcage.base.files import write_bytes
from vcage.base.keeper import Keeper
from vcage.base.pictures import jpeg
from vcage.base.version import __version__
from vcage.datasets.recordings.recording import Recording
from vcage.datasets.robotwin import JPEG_QUALITY
from vcage.schema.compression import ClipRecord, VideoStream
from vcage.video.choices import Choices, Criterion
from vcage.video.encoders import encoder_version
from vcage.video.jod import JodMetric, metric_version
from vcage.video.judge import Judge
from vcage.video.keyframes import keyframes, picture_keyframes
from vcage.video.search import SearchResult, search_clip

Key = tuple[str, str]
"""Recording and camera."""


@dataclass(frozen=True)
class Clip:
    """One camera of one recording.

    Args:
        name: of the recording, unique in the data set; with the camera's it names the video.
        recording: of the pictures.
        camera: its name.
        fps: frames per second.
        window: its frames; None for all.
    """

    name: str
    recording: Recording
    camera: str
    fps: float
    window: range | None = None

    @property
    def key(self) -> Key:
        """Identity among other clips."""
        return self.name, self.camera

    @property
    def video(self) -> str:
        """Name of the encoded video."""
        return f"{self.name}.{self.camera}.mp4"

    @property
    def frames(self) -> range:
        """Indices of its frames."""
        return range(self.recording.camera(self.camera).frames) if self.window is None else self.window

    def pictures(self) -> NDArray[np.uint8]:
        """(T, H, W, 3) uint8 RGB."""
        return self.recording.pictures(self.camera, self.window)

    def keyframes(self, pictures: NDArray[np.uint8], count: int) -> list[int]:
        """Return about ``count`` of the ``pictures``, by the commands to the robot if they are known."""
        motion = self.recording.motion
        if motion is None:
            return picture_keyframes(pictures, count)
        action = motion.values
        if spare := self.recording.SPARE_PICTURES:  # pictures after the last command
            action = np.concatenate([action, np.repeat(action[-1:], spare, axis=0)])
        return keyframes(action if self.window is None else action[self.window], motion.grippers, count)


@dataclass(frozen=True)
class EncodedVideo:
    """The video of a clip, and its record."""

    file: Path
    stream: VideoStream


@dataclass(frozen=True)
class SearchTask:
    """One search.

    Args:
        clip: to be encoded.
        choices: of encodings.
        criterion: to pass.
        display: of the metric.
        keyframes: number of scored frames.
        folder: for the video and its record.
    """

    clip: Clip
    choices: Choices
    criterion: Criterion
    display: str
    keyframes: int
    folder: Path

    @cached_property
    def made_from(self) -> str:
        """Hash of everything the result depends on, as of the first access."""
        recording, encoder = self.clip.recording, self.choices.settings()
        facts = (
            str(recording.path.resolve()),
            str(recording),
            [(stat.st_size, stat.st_mtime_ns) for stat in (file.stat() for file in recording.files)],
            recording.swapped(self.clip.camera),
            self.clip.fps,
            self.clip.window,
            self.choices,
            self.criterion,
            self.display,
            self.keyframes,
            encoder_version(self.choices.codec),
            encoder.facts.options(encoder.effort, encoder.preset, encoder.gop, encoder.facts.min_crf),
            metric_version(),
            __version__,
        )
        return hashlib.sha256(repr(facts).encode()).hexdigest()

    @property
    def record(self) -> Path:
        """Path of its :class:`ClipRecord`; records of one clip with other choices are neighbours."""
        return self.folder / f"{self.clip.video.removesuffix('.mp4')}.{self.made_from[:12]}.json"

    @property
    def video(self) -> Path:
        """Path of the encoded video."""
        return self.record.with_suffix(".mp4")


def known(task: SearchTask) -> VideoStream | None:
    """Return the result of an earlier call of :func:`perform`, or None."""
    record = Keeper(task.record, ClipRecord, task.made_from).kept()
    return None if record is None else record.stream


def is_finished(task: SearchTask) -> bool:
    """True if the video is there, as :func:`perform` left it."""
    stream = known(task)
    return stream is not None and task.video.is_file() and task.video.stat().st_size == stream.bytes


def perform(task: SearchTask) -> VideoStream:
    """Search one clip, write its video, and then its record.

    Raises:
        DamagedFile: its pictures cannot be read; ``details`` name the recording.
        UsageError, MissingDependency: see :func:`vcage.video.search.search_clip`.
        DiskFull, OutputFolderError: it cannot be written.
    """
    judge = _judge(task)
    result = search_clip(judge, task.choices)
    write_bytes(task.video, result.video)
    stream = _stream(task.clip, judge, result)
    ClipRecord(made_from=task.made_from, stream=stream).write(task.record)
    return stream


def _judge(task: SearchTask) -> Judge:
    try:
        frames = task.clip.pictures()
        scored = task.clip.keyframes(frames, task.keyframes)
    except DamagedFile as error:
        error.details["recording"] = task.clip.name
        raise
    return Judge(frames, scored, task.clip.fps, task.criterion, _metric(task.display))


@lru_cache(maxsize=1)
def _metric(display: str) -> JodMetric:
    """Return the metric, made once for each process, in whose main thread alone it is used."""
    return JodMetric(display)


def _stream(clip: Clip, judge: Judge, result: SearchResult) -> VideoStream:
    frames = judge.frames
    return VideoStream(
        episode=clip.name,
        camera=clip.camera,
        file=clip.video,
        frames=len(frames),
        bytes=len(result.video),
        sha256=hashlib.sha256(result.video).hexdigest(),
        raw_bytes=frames.nbytes,
        jpeg_bytes=jpeg_bytes(frames),
        stored_bytes=clip.recording.camera(clip.camera).stored_bytes,
        codec=result.settings.codec,
        pixel_format=result.pixel_format,
        gop=result.settings.gop,
        crf=result.crf,
        loss_max=result.loss_max,
        loss_mean=result.loss_mean,
        held_out=result.held_out,
        keyframes=list(judge.keyframes),
        guarded=result.added,
        evaluations=result.trials,
    )


def jpeg_bytes(frames: NDArray[np.uint8]) -> int:
    """Return the bytes of the pictures, (T, H, W, 3) uint8 RGB, as JPEG, the way RoboTwin stores them."""
    return sum(len(jpeg(frame, JPEG_QUALITY)) for frame in frames)
