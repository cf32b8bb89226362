"""How small recordings would become and how long it would take, from a few seconds of a few of them."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
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
from vcage.datasets.packing.frames import as_text, show_frames
from vcage.datasets.packing.output import omitted, other_streams
from vcage.datasets.packing.pack import Order, notes_of, prepare
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.recordings.colours import as_json, colour_orders
from vcage.schema.compression import VideoStream

SAMPLE = 3
"""Clips of each camera that are looked at."""

WINDOW = 60
"""Frames that are searched of a clip, from its middle."""


def estimate(order: Order, *, workers: int | None = None, progress: Progress = silent) -> dict[str, Any]:
    """What :func:`vcage.datasets.packing.pack.pack` would write, without writing anything.

    Args:
        order: what would be done.
        workers: processes at most, for the time.
        progress: told of each clip of the sample.

    Returns:
        JSON-serialisable: what :func:`estimate_clips` tells, the recordings that are left, what a user must know, and
        what is left out.

    Raises:
        VcageError: see :func:`vcage.datasets.packing.pack.pack`.
    """
    prepared = prepare(order)
    sources, told = prepared.without_damaged(
        lambda clips: estimate_clips(clips, order.settings, workers=workers, progress=progress)
    )
    others = other_streams(sources.sources, prepared.output)
    return {
        "would": "write",
        "out": str(order.out),
        "recordings": len(sources.sources),
        **told,
        "colours": as_json(colour_orders(source.recording.colours for source in sources.sources)),
        "other_streams": as_json(others),
        "frames_picture": as_text(show_frames(order.root, [source.recording for source in sources.sources])),
        "notes": {name: texts for name, texts in notes_of(sources, prepared.output).items() if texts},
        **omitted(sources, prepared.output),
    }


def estimate_clips(
    clips: Sequence[Clip], settings: CompressionSettings, *, workers: int | None = None, progress: Progress = silent
) -> dict[str, Any]:
    """What the search would make of clips, from one over the middles of a few of them.

    Args:
        clips: all of them.
        settings: how.
        workers: processes at most, for the time; the estimate itself is made in this process.
        progress: told of each clip of the sample.

    Returns:
        JSON-serialisable: per camera the CRFs of the sample, and bytes of all frames; the sums of these, and seconds,
        rather too many, as the one clip of each camera that is searched weighs more among few.

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
    """What all clips of a camera come to, if they are like the sample."""
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
    """The clip, as if no more had been recorded than the frames in its middle."""
    first = max(0, (len(clip.frames) - WINDOW) // 2)
    return replace(clip, window=clip.frames[first : first + WINDOW])


def sample_of(clips: Sequence[Clip]) -> list[Clip]:
    """A few clips of each camera: of those in the order of their pictures' bytes the first, the last, and between."""
    sample = []
    for camera in cameras_of(clips):
        own = sorted((clip for clip in clips if clip.camera == camera), key=stored_per_frame, reverse=True)
        places = np.unique(np.linspace(0, len(own) - 1, SAMPLE).round().astype(int))
        sample += [own[place] for place in places]
    return sample
