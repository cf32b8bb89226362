"""How small recordings would become and how long it would take, from a few seconds of a few of them."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from vcage.compression.jod import JodMetric
from vcage.compression.keyframes import picture_keyframes
from vcage.compression.search import search_clip
from vcage.packing.campaign import cameras_of, require_tools, sample_of, workers_for
from vcage.packing.clips import Clip, jpeg_bytes
from vcage.packing.pack import Order, require_apart
from vcage.packing.settings import CompressionSettings
from vcage.packing.sources import find_sources
from vcage.packing.targets import require_alike, suited
from vcage.progress import Progress, silent

WINDOW = 60
"""Frames that are searched of a clip, from its middle."""


@dataclass(frozen=True)
class Probe:
    """A part of one clip, searched.

    Args:
        clip: which.
        frames: how many of its frames.
        jpeg_bytes: of these.
        bytes, crf: what the search found.
        seconds: that it took.
    """

    clip: Clip
    frames: int
    jpeg_bytes: int
    bytes: int
    crf: int | None
    seconds: float


def estimate(order: Order, *, workers: int | None = None, progress: Progress = silent) -> dict[str, Any]:
    """What :func:`vcage.packing.pack.pack` would write, without writing anything.

    Args:
        order: what would be done.
        workers: processes at most, for the time.
        progress: told of each clip of the sample.

    Returns:
        JSON-serialisable: per camera CRF, bytes and seconds of all its frames; and their sums.

    Raises:
        VcageError: see :func:`vcage.packing.pack.pack`.
    """
    require_apart(order)
    require_tools(order.settings)
    sources = find_sources(order.root, order.settings, skip_damaged=order.skip_damaged)
    wanted = suited(order.wanted, sources.sources)
    clips = sources.clips(order.cameras, wanted.fps)
    require_alike(clips, wanted)
    sample = sample_of(clips)
    metric = JodMetric(order.settings.display)
    probes = []
    for number, clip in enumerate(sample):
        progress(f"{clip.name} {clip.camera}", number, len(sample))
        probes.append(_probe(clip, order.settings, metric))
    cameras = {
        name: _camera([c for c in clips if c.camera == name], [p for p in probes if p.clip.camera == name])
        for name in cameras_of(clips)
    }
    total = {key: sum(camera[key] for camera in cameras.values()) for key in ("bytes", "raw_bytes", "jpeg_bytes")}
    seconds = sum(camera["seconds"] for camera in cameras.values())
    return {
        "would": "write",
        "out": str(order.out),
        "recordings": len(sources.sources),
        "videos": len(clips),
        "sampled_frames": sum(probe.frames for probe in probes),
        **total,
        "reduction_raw": round(1 - total["bytes"] / total["raw_bytes"], 4),
        "reduction_jpeg": round(1 - total["bytes"] / total["jpeg_bytes"], 4),
        "seconds": round(seconds / (workers or workers_for(clips))),
        "cameras": cameras,
    }


def _probe(clip: Clip, settings: CompressionSettings, metric: JodMetric) -> Probe:
    count = clip.recording.camera(clip.camera).frames
    first = max(0, (count - WINDOW) // 2)
    frames = clip.recording.pictures(clip.camera, range(first, min(count, first + WINDOW)))
    begun = time.perf_counter()
    scored = picture_keyframes(frames, settings.keyframes)
    result = search_clip(frames, scored, clip.fps, settings.choices(), settings.criterion(), metric)
    return Probe(clip, len(frames), jpeg_bytes(frames), len(result.video), result.crf, time.perf_counter() - begun)


def _camera(clips: Sequence[Clip], probes: Sequence[Probe]) -> dict[str, Any]:
    """What all clips of a camera come to, if they are like the sample."""
    frames = sum(clip.recording.camera(clip.camera).frames for clip in clips)
    share = frames / sum(probe.frames for probe in probes)
    return {
        "crf": [probe.crf for probe in probes],
        "frames": frames,
        "bytes": round(share * sum(probe.bytes for probe in probes)),
        "raw_bytes": sum(clip.recording.camera(clip.camera).raw_bytes for clip in clips),
        "jpeg_bytes": round(share * sum(probe.jpeg_bytes for probe in probes)),
        "seconds": round(share * sum(probe.seconds for probe in probes), 1),
    }
