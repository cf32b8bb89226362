"""HEVC, AV1 or H.264 in MP4 (through PyAV): the Image → Video → Image loop of the paper, section III-D.

Colour: the pictures are converted with the BT.601 matrix in limited range, and tagged so. That matrix is what readers
assume that ignore the tag (OpenCV, swscale's default), so they and those that honour it show the same colours.

The same frames and settings give the same bytes on any number of cores: each encoder has one thread, and x265's info
message, which names the machine, is left out. Cores are kept busy by parallel videos.
"""

from __future__ import annotations

import io
import os
from collections.abc import Collection
from dataclasses import dataclass
from fractions import Fraction
from typing import cast

import av
import numpy as np
from av.video.frame import PictureType
from av.video.reformatter import ColorPrimaries, ColorRange, Colorspace, ColorTrc, Interpolation, VideoReformatter
from numpy.typing import NDArray

from vcage.base.errors import UnknownName, UsageError
from vcage.schema.compression import Effort
from vcage.video.encoders import CODECS, Codec, kept_priority, require_encoder

CONTAINER = "mp4"

SMALLEST = 16
"""Fewest pixels along a side that every encoder takes."""

BT601 = 6
"""ISO/IEC 23001-8 matrix coefficients of SMPTE 170M, the same numbers as BT.601."""

RGB_MATRIX = 0

EXACT = (
    Interpolation.BICUBIC
    | Interpolation.ACCURATE_RND
    | Interpolation.FULL_CHR_H_INP
    | Interpolation.FULL_CHR_H_INT
    | Interpolation.BITEXACT
)
"""swscale's most exact conversion; its default darkens 8-bit 4:2:0 by about one step."""


@dataclass(frozen=True)
class EncoderSettings:
    """Settings of a stream's encoder without the CRF.

    Args:
        codec: a name of :data:`vcage.video.encoders.CODECS`.
        pixel_format: FFmpeg's name; none takes the codec's best. 10-bit 4:4:4 gives the conversion itself no loss
            (measured: 0.000 JOD, against 0.06–0.13 for ``yuv420p``, which takes up most of the usual threshold of 0.1
            or exceeds it).
        effort: time against bytes.
        gop: frames from one random-access point to the next.

    Raises:
        UnknownName: there is no such codec, or it has no such pixel format, or there is no such effort.
        UsageError: the gop is not positive.
    """

    codec: str = "hevc"
    pixel_format: str = ""
    effort: Effort = "default"
    gop: int = 10

    def __post_init__(self) -> None:
        if self.codec not in CODECS:
            raise UnknownName("codec", self.codec, CODECS)
        object.__setattr__(self, "pixel_format", self.pixel_format or self.facts.pixel_formats[0])
        formats = self.facts.pixel_formats + self.facts.other_formats
        if self.pixel_format not in formats:
            raise UnknownName(f"pixel format of {self.codec}", self.pixel_format, formats)
        if self.effort not in self.facts.presets:
            raise UnknownName("effort", self.effort, self.facts.presets)
        if self.gop < 1:
            raise UsageError(f"gop is {self.gop}, expected at least 1")

    @property
    def facts(self) -> Codec:
        """Facts of its codec's encoder."""
        return CODECS[self.codec]

    @property
    def preset(self) -> str:
        """The encoder's preset."""
        return self.facts.presets[self.effort]


def encode(
    frames: NDArray[np.uint8],
    fps: float,
    settings: EncoderSettings,
    crf: int | None,
    starts: Collection[int] = (),
) -> bytes:
    """Encode pictures as an MP4 file with one stream.

    Args:
        frames: (T, H, W, 3) uint8 RGB, of a size that :func:`formats_for` finds a format for.
        fps: frames per second.
        settings: the encoder's.
        crf: constant rate factor of the codec; None encodes RGB without any loss.
        starts: frames at which a group of pictures begins, besides those of the GOP.

    Raises:
        UsageError: the size does not fit the pixel format or is too small, the CRF is out of range, or the codec has
            no lossless form.
        MissingDependency: this build of PyAV lacks the encoder.
    """
    codec = settings.facts
    _check(frames, settings, crf)
    require_encoder(codec)
    pixel_format = codec.lossless_format if crf is None else settings.pixel_format
    os.environ.setdefault("SVT_LOG", "1")  # SVT-AV1 else describes itself on stderr for every file
    target = io.BytesIO()
    with av.open(target, "w", format=CONTAINER, container_options={"fflags": "+bitexact"}) as container:
        encoder = codec.lossless_encoder if crf is None else codec.encoder
        added = container.add_stream(encoder, rate=Fraction(fps).limit_denominator(1001))
        stream = cast("av.VideoStream", added)  # the stub knows no stream by a name that is not written out
        stream.height, stream.width = frames.shape[1:3]
        stream.pix_fmt = pixel_format
        stream.codec_tag = codec.tag
        rgb, context = is_rgb(pixel_format), stream.codec_context
        context.colorspace = RGB_MATRIX if rgb else BT601
        context.color_range = ColorRange.JPEG if rgb else ColorRange.MPEG
        context.color_primaries, context.color_trc = ColorPrimaries.BT709, ColorTrc.IEC61966_2_1
        stream.options = {**codec.options(settings.effort, settings.preset, settings.gop, crf)}
        with kept_priority():
            context.open()
        converter = VideoReformatter()
        for index, picture in enumerate(frames):
            container.mux(stream.encode(converted(picture, pixel_format, converter, index, start=index in starts)))
        container.mux(stream.encode(None))
    return target.getvalue()


def formats_for(settings: EncoderSettings, width: int, height: int, names: Collection[str] = ()) -> list[str]:
    """Return the pixel formats of a codec that can hold pictures of a size: odd ones need chroma of the full size.

    Args:
        settings: the encoder's; only its codec counts.
        width, height: of the pictures, pixels.
        names: the formats to choose from; empty for the codec's default search.

    Returns:
        At least one, the best first.

    Raises:
        UsageError: no format can.
    """
    codec = settings.facts
    fitting = [name for name in codec.pixel_formats + codec.other_formats if _fits(name, width, height)]
    if not fitting or min(width, height) < SMALLEST:
        raise UsageError(
            f"pictures of {width}x{height} cannot be encoded as {settings.codec}",
            hint=f"sides are at least {SMALLEST} pixels"
            + ("" if settings.codec != "av1" else ", and even for av1: use --codec hevc, which allows odd ones"),
        )
    chosen = [name for name in fitting if name in (names or codec.pixel_formats)]
    if not chosen:
        raise UsageError(
            f"pictures of {width}x{height} do not fit the pixel format {', '.join(names)}",
            hint=f"take one of {', '.join(fitting)}",
        )
    return chosen


def _fits(pixel_format: str, width: int, height: int) -> bool:
    horizontal = 2 if "420" in pixel_format or "422" in pixel_format else 1
    vertical = 2 if "420" in pixel_format else 1
    return width % horizontal == 0 and height % vertical == 0


def _check(frames: NDArray[np.uint8], settings: EncoderSettings, crf: int | None) -> None:
    if frames.ndim != 4 or frames.shape[3] != 3 or frames.dtype != np.uint8 or len(frames) == 0:
        raise ValueError(f"frames are {frames.shape} {frames.dtype}, expected (T, H, W, 3) uint8 with T > 0")
    height, width = frames.shape[1:3]
    formats_for(settings, width, height, () if crf is None else (settings.pixel_format,))
    if crf is None:
        if not settings.facts.lossless_format:
            raise UsageError(f"{settings.codec} has no lossless form here", hint="hevc and h264 have one")
        return
    if not settings.facts.min_crf <= crf <= settings.facts.max_crf:
        raise UsageError(f"crf is {crf}, expected {settings.facts.min_crf} … {settings.facts.max_crf}")


def is_rgb(pixel_format: str) -> bool:
    """True if a video in a pixel format holds RGB as it is; all others hold YUV, see this module."""
    return pixel_format.startswith(("gbr", "rgb"))


def converted(
    picture: NDArray[np.uint8], pixel_format: str, converter: VideoReformatter, index: int = 0, *, start: bool = False
) -> av.VideoFrame:
    """Return a picture in the encoder's pixel format, for the time ``index`` in frames.

    Args:
        picture: (H, W, 3) uint8 RGB.
        pixel_format: FFmpeg's name.
        converter: of all pictures of a video, as its tables take longer than their use.
        index: the time of the picture, in frames.
        start: true if a group of pictures begins with it, in addition to the encoder's own.
    """
    frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")
    if pixel_format.startswith("gbr"):
        frame = converter.reformat(frame, format=pixel_format, interpolation=EXACT, threads=1)
    elif pixel_format != "rgb24":
        frame = converter.reformat(
            frame,
            format=pixel_format,
            dst_colorspace=Colorspace.ITU601,
            dst_color_range=ColorRange.MPEG,
            interpolation=EXACT,
            threads=1,
        )
    frame.pts = index
    if start:
        frame.pict_type = PictureType.I
    return frame


def only_converted(pictures: NDArray[np.uint8], pixel_format: str) -> NDArray[np.uint8]:
    """Return (N, H, W, 3) uint8 RGB after a pixel format without any codec: no CRF can be better."""
    converter = VideoReformatter()
    frames = [converted(picture, pixel_format, converter) for picture in pictures]
    for frame in frames if not pixel_format.startswith("gbr") else ():
        frame.colorspace, frame.color_range = BT601, ColorRange.MPEG  # as the stream, for the same conversion back
    return np.stack([frame.to_ndarray(format="rgb24") for frame in frames], dtype=np.uint8)
