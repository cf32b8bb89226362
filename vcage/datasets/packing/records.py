"""The record of a compression, which lies beside the videos."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

from vcage.base.folders import natural_key
from vcage.datasets.packing.settings import CompressionSettings
from vcage.schema.base import Provenance
from vcage.schema.compression import CameraCompression, Compression, Encoding, VideoStream
from vcage.video.codec import is_rgb
from vcage.video.encoders import CODECS, encoder_version
from vcage.video.jod import metric_version

T = TypeVar("T")


def compression_record(
    provenance: Provenance, settings: CompressionSettings, streams: Sequence[VideoStream], **facts: Any
) -> Compression:
    """Return the record of streams that were all made with the same settings.

    Args:
        provenance: of the record.
        settings: of the streams.
        streams: empty where no episode counts any more.
        facts: other fields of :class:`Compression`.
    """
    cameras = sorted({stream.camera for stream in streams}, key=natural_key)
    return Compression(
        provenance=provenance,
        encoding=_encoding(settings),
        cameras=[_camera(name, [s for s in streams if s.camera == name]) for name in cameras],
        streams=list(streams),
        reduction_raw=_reduction(streams, "raw_bytes"),
        reduction_jpeg=_reduction(streams, "jpeg_bytes"),
        reduction_stored=_reduction(streams, "stored_bytes"),
        **facts,
    )


def _encoding(settings: CompressionSettings) -> Encoding:
    return Encoding(
        codec=settings.codec,
        encoder=CODECS[settings.codec].encoder,
        encoder_version=encoder_version(settings.codec),
        effort=settings.effort,
        preset=settings.choices().settings().preset,
        metric=metric_version(),
        display=settings.display,
        reduce=settings.reduce,
        threshold=settings.max_loss,
        guard=settings.guard and settings.crf is None,
        scope=settings.scope if settings.crf is None else "fixed",
    )


def _camera(name: str, streams: Sequence[VideoStream]) -> CameraCompression:
    held_out = [stream.held_out.worst for stream in streams if stream.held_out is not None]
    rgb = [is_rgb(stream.pixel_format) for stream in streams]
    return CameraCompression(
        camera=name,
        pixel_format=_common([stream.pixel_format for stream in streams]),
        matrix=_common(["RGB" if one else "BT.601" for one in rgb]),
        range=_common(["full" if one else "limited" for one in rgb]),
        gop=_common([stream.gop for stream in streams]),
        crf=_common([stream.crf for stream in streams]),
        lossless=all(stream.lossless for stream in streams),
        loss_max=max(stream.loss_max for stream in streams),
        held_out_max=max(held_out, default=None),
    )


def _common(values: Sequence[T]) -> T | None:
    return values[0] if len(set(values)) == 1 else None


def _reduction(streams: Sequence[VideoStream], baseline: str) -> float:
    if not streams:
        return 0.0
    before = sum(getattr(stream, baseline) for stream in streams)
    return round(1 - sum(stream.bytes for stream in streams) / max(before, 1), 5)
