"""Recordings with their videos as a LeRobot data set wants them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vcage.datasets.lerobot.episode import LeRobotEpisode, episode_of
from vcage.datasets.lerobot.statistics import picture_histogram
from vcage.datasets.packing.targets import Wanted
from vcage.datasets.reader import EpisodeReader
from vcage.datasets.recordings.hdf5_layouts import VcageEpisode
from vcage.datasets.recordings.recording import Recording
from vcage.schema.compression import VideoStream

SAMPLES = 50
"""Pictures per episode and camera, evenly spaced, for the statistics of pixels."""


def lerobot_episode(recording: Recording, videos: Mapping[str, Path], wanted: Wanted) -> LeRobotEpisode:
    """A recording with its videos, as an episode of a LeRobot data set."""
    frames = recording.camera(next(iter(videos))).frames
    sample = np.unique(np.linspace(0, frames - 1, SAMPLES).astype(int)).tolist()
    histograms = {camera: picture_histogram(recording.pictures(camera, sample)) for camera in videos}
    if isinstance(recording, VcageEpisode):
        with EpisodeReader(recording.path) as reader:
            return episode_of(reader.episode, videos, histograms, len(sample))
    return _foreign(recording, videos, histograms, len(sample), wanted, frames)


def _foreign(
    recording: Recording,
    videos: Mapping[str, Path],
    histograms: Mapping[str, NDArray[np.int64]],
    sampled: int,
    wanted: Wanted,
    frames: int,
) -> LeRobotEpisode:
    motion = recording.motion
    return LeRobotEpisode(
        fps=recording.fps or wanted.fps or 0.0,
        robot=recording.robot or wanted.robot or "unknown",
        task=recording.task or wanted.task or "",
        videos=videos,
        histograms=histograms,
        sampled=sampled,
        state=recording.state,
        state_names=recording.state_names,
        action=None if motion is None else motion.action,
        action_names=recording.action_names,
        frames=frames,
    )


def encodings(streams: Sequence[VideoStream], preset: str) -> dict[str, dict[str, Any]]:
    """Camera → what ``info.json`` says of its encoding beyond the stream itself, if all its streams have it alike.

    Args:
        streams: of all cameras.
        preset: of the encoder, for all.
    """
    told: dict[str, dict[str, Any]] = {}
    for camera in sorted({stream.camera for stream in streams}):
        own = [stream for stream in streams if stream.camera == camera]
        facts: dict[str, Any] = {"video.g": own[0].gop, "video.crf": own[0].crf}
        if own[0].lossless:
            facts = {"video.g": own[0].gop, "video.lossless": True}
        alike = all((s.pixel_format, s.gop, s.crf) == (own[0].pixel_format, own[0].gop, own[0].crf) for s in own)
        told[camera] = {**(facts if alike else {"video.pix_fmt": None}), "video.preset": preset}
    return told
