"""Estimate of the size and time of a compression, from a few seconds of a few recordings."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from vcage.base.leftovers import scratch_folder
from vcage.base.progress import Progress, silent
from vcage.datasets.packing.clips import Clip
from vcage.datasets.packing.dataset_search import (
    cameras_of,
    search_data_set,
    stored_per_frame,
    workers_for,
)
from vcage.datasets.packing.inspecting import as_text, show_frames
from vcage.datasets.packing.output import omitted
from vcage.datasets.packing.pack import Order, prepare
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.recordings.colours import as_json
from vcage.schema.compression import VideoStream


@dataclass(frozen=True)
class SampleSettings:
    """Size of the sample that is searched.

    Args:
        clips: of each camera.
        frames: of each clip, from its middle.
    """

    clips: int = 3
    frames: int = 60


SETTINGS = SampleSettings()


def estimate(order: Order, *, workers: int | None = None, progress: Progress = silent) -> dict[str, Any]:
    """Estimate the result of :func:`vcage.datasets.packing.pack.pack` without writing anything.

    Args:
        order: of the work.
        workers: processes at most, for the time.
        progress: called for each clip of the sample.

    Returns:
        JSON-serialisable: the figures of :func:`estimate_clips`, the remaining recordings, notes, and omissions.

    Raises:
        VcageError: see :func:`vcage.datasets.packing.pack.pack`.
    """
    written, figures = prepare(order).without_damaged(
        lambda left: estimate_clips(left.clips(), order.settings, workers=workers, progress=progress)
    )
    facts, recordings = written.facts(), [source.recording for source in written.sources.sources]
    return {
        "would": "write",
        "out": str(order.out),
        "recordings": len(recordings),
        **figures,
        "colours": as_json(facts["colours"]),
        "other_streams": as_json(facts["other_streams"]),
        "frames_picture": as_text(show_frames(order.root, recordings)),
        "notes": facts["notes"],
        **omitted(facts["left_out"], facts["failed"]),
    }


def estimate_clips(
    clips: Sequence[Clip], settings: CompressionSettings, *, workers: int | None = None, progress: Progress = silent
) -> dict[str, Any]:
    """Estimate the result of a search over clips, by one over the middles of a few of them.

    Args:
        clips: all of them.
        settings: of the search.
        workers: processes at most, for the time; the estimate itself is made in this process.
        progress: called for each clip of the sample.

    Returns:
        JSON-serialisable: per camera the CRFs of the sample, and bytes of all frames; the sums of these, and seconds,
        rather too many, as the one searched clip of each camera weighs more among few.

    Raises:
        VcageError: see :func:`vcage.datasets.packing.dataset_search.search_data_set`.
    """
    workers = workers_for(clips, workers)
    sample = [_middle(clip) for clip in sample_of(clips)]
    begun = time.perf_counter()
    with scratch_folder() as folder:
        videos = search_data_set(sample, settings, folder, workers=1, progress=progress)
        streams = [video.stream for video in videos.values()]
    seconds = time.perf_counter() - begun
    cameras = {
        name: _camera([c for c in clips if c.camera == name], [s for s in streams if s.camera == name])
        for name in cameras_of(clips)
    }
    total = {key: sum(camera[key] for camera in cameras.values()) for key in ("bytes", "raw_bytes", "jpeg_bytes")}
    share = total["raw_bytes"] / sum(stream.raw_bytes for stream in streams)
    return {
        "videos": len(clips),
        "sampled_frames": sum(stream.frames for stream in streams),
        **total,
        "reduction_raw": round(1 - total["bytes"] / total["raw_bytes"], 4),
        "reduction_jpeg": round(1 - total["bytes"] / total["jpeg_bytes"], 4),
        "seconds": round(share * seconds / workers),
        "cameras": cameras,
    }


def _camera(clips: Sequence[Clip], streams: Sequence[VideoStream]) -> dict[str, Any]:
    """Return the figures of all clips of a camera, if they are like the sample."""
    frames = sum(len(clip.frames) for clip in clips)
    share = frames / sum(stream.frames for stream in streams)
    return {
        "crf": [stream.crf for stream in streams],
        "frames": frames,
        "bytes": round(share * sum(stream.bytes for stream in streams)),
        "raw_bytes": sum(clip.recording.camera(clip.camera).raw_bytes for clip in clips),
        "jpeg_bytes": round(share * sum(stream.jpeg_bytes for stream in streams)),
    }


def _middle(clip: Clip) -> Clip:
    """Return the frames in the middle of a clip."""
    first = max(0, (len(clip.frames) - SETTINGS.frames) // 2)
    return replace(clip, window=clip.frames[first : first + SETTINGS.frames])


def sample_of(clips: Sequence[Clip]) -> list[Clip]:
    """Return a few clips of each camera, evenly spaced in the order of their pictures' bytes."""
    sample = []
    for camera in cameras_of(clips):
        own = sorted((clip for clip in clips if clip.camera == camera), key=stored_per_frame, reverse=True)
        places = np.unique(np.linspace(0, len(own) - 1, SETTINGS.clips).round().astype(int))
        sample += [own[place] for place in places]
    return sample
