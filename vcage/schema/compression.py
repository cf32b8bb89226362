"""What compression chose, and what it cost and saved."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from vcage.schema.base import Finite, Record, StageDocument


class Evaluation(Record):
    """One point of the CRF search: one encoding of one episode's video."""

    episode: str = Field(default="", description="episode file that was encoded")
    crf: int
    loss_max: Finite = Field(description="largest JOD loss over the keyframes")
    loss_mean: Finite
    bytes: int


class Encoding(Record):
    """How the streams were encoded and judged."""

    codec: str
    encoder: str
    pixel_format: str
    preset: str
    gop: int
    display: str = Field(description="ColorVideoVDP display model")
    reduce: str = Field(description="'max' or 'mean' over the keyframes")
    threshold: Finite = Field(description="largest JOD loss allowed")


class CameraCompression(Record):
    """The search for one camera."""

    camera: str
    crf: int | None = Field(
        description="highest CRF whose loss stays under the threshold; none when even the best fails"
    )
    lossless: bool
    loss_max: Finite
    evaluations: list[Evaluation]
    keyframes: dict[str, list[int]] = Field(description="episode file → frame indices")


class StreamSize(Record):
    """One encoded video against its baselines, bytes."""

    episode: str
    camera: str
    file: str
    frames: int
    bytes: int
    raw_bytes: int = Field(description="uint8 RGB")
    jpeg_bytes: int = Field(description="JPEG quality 95, as RoboTwin's HDF5 stores it")


class Compression(StageDocument):
    """``compress/compression.json``."""

    SCHEMA: ClassVar[str] = "vcage.compression/1"

    encoding: Encoding
    cameras: list[CameraCompression]
    streams: list[StreamSize]
    reduction_raw: Finite = Field(description="1 − bytes / raw bytes")
    reduction_jpeg: Finite
