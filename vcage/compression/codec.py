"""HEVC in MP4 by libx265 (through PyAV): the Image → Video → Image loop of the paper, section III-D.

Colour: the pictures are converted with the BT.601 matrix in limited range, and tagged so. That matrix is what readers
assume that ignore the tag (OpenCV, swscale's default), so they and those that honour it show the same colours.

The same frames and settings give the same bytes on every number of cores: x265's frame threads and look-ahead slices,
which change its decisions, are fixed, and its info message, which names the machine, is left out.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from fractions import Fraction

import av
import numpy as np
from av.video.reformatter import ColorPrimaries, ColorRange, Colorspace, ColorTrc, Interpolation
from numpy.typing import NDArray

from vcage.errors import MissingDependency, UsageError

CODEC = "hevc"
ENCODER = "libx265"
CONTAINER = "mp4"
MAX_CRF = 51

LOSSLESS_FORMAT = "gbrp"
"""RGB itself: nothing is lost in a colour conversion."""

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
    """How a stream is encoded, but for its CRF.

    Args:
        pixel_format: FFmpeg's name. 10-bit 4:4:4 gives the conversion itself no loss (measured: 0.000 JOD, against
            0.09–0.13 for ``yuv420p``, which alone exceeds the usual threshold).
        preset: x265's; slower ones save less than 5 % here.
        gop: frames from one random-access point to the next.
    """

    pixel_format: str = "yuv444p10le"
    preset: str = "faster"
    gop: int = 10


def encode(frames: NDArray[np.uint8], fps: float, settings: EncoderSettings, crf: int | None) -> bytes:
    """Encode pictures as an MP4 file with one HEVC stream.

    Args:
        frames: (T, H, W, 3) uint8 RGB, H and W even.
        fps: frames per second.
        settings: the encoder's.
        crf: constant rate factor, 0 … 51; None encodes RGB without any loss.

    Raises:
        UsageError: the size is odd or too small, or the CRF out of range.
        MissingDependency: this build of PyAV has no libx265.
    """
    _check(frames, crf)
    pixel_format = LOSSLESS_FORMAT if crf is None else settings.pixel_format
    target = io.BytesIO()
    with av.open(target, "w", format=CONTAINER, container_options={"fflags": "+bitexact"}) as container:
        stream = container.add_stream(ENCODER, rate=Fraction(fps).limit_denominator(1001))
        stream.height, stream.width = frames.shape[1:3]
        stream.pix_fmt = pixel_format
        stream.codec_tag = "hvc1"  # the tag that Apple's players ask for; all others read it too
        _tag_colour(stream.codec_context, rgb=pixel_format.startswith("gbr"))
        stream.options = {"preset": settings.preset, "x265-params": _x265_params(settings, crf)}
        for index, picture in enumerate(frames):
            container.mux(stream.encode(_video_frame(picture, pixel_format, index)))
        container.mux(stream.encode(None))
    return target.getvalue()


def _check(frames: NDArray[np.uint8], crf: int | None) -> None:
    if frames.ndim != 4 or frames.shape[3] != 3 or frames.dtype != np.uint8 or len(frames) == 0:
        raise ValueError(f"frames are {frames.shape} {frames.dtype}, expected (T, H, W, 3) uint8 with T > 0")
    height, width = frames.shape[1:3]
    if height % 2 or width % 2 or min(height, width) < 32:
        raise UsageError(
            f"a video of {width}x{height} cannot be encoded: width and height must be even and at least 32",
            hint="change the camera's size in assets/robots and collect again",
        )
    if crf is not None and not 0 <= crf <= MAX_CRF:
        raise UsageError(f"crf is {crf}, expected 0 … {MAX_CRF}")
    if ENCODER not in av.codecs_available:
        raise MissingDependency(f"PyAV has no {ENCODER}", hint="pip install --force-reinstall --only-binary av av")


def _x265_params(settings: EncoderSettings, crf: int | None) -> str:
    params: dict[str, str | int] = {
        "keyint": settings.gop,
        "min-keyint": settings.gop,
        "scenecut": 0,
        "open-gop": 0,  # an open GOP gives wrong frames after a seek
        "cutree": 0,  # measured: a quarter fewer bytes at 0.1 JOD in the worst frame, for cutree starves it
        "sao": 0,  # measured: a quarter less time for 2 % more bytes
        "frame-threads": 1,
        "lookahead-slices": 0,
        "wpp": 1,
        "info": 0,
        "log-level": "none",
        **({"lossless": 1} if crf is None else {"crf": crf}),
    }
    return ":".join(f"{name}={value}" for name, value in params.items())


def _tag_colour(context: av.VideoCodecContext, *, rgb: bool) -> None:
    context.colorspace = RGB_MATRIX if rgb else BT601
    context.color_range = ColorRange.JPEG if rgb else ColorRange.MPEG
    context.color_primaries = ColorPrimaries.BT709
    context.color_trc = ColorTrc.IEC61966_2_1


def _video_frame(picture: NDArray[np.uint8], pixel_format: str, index: int) -> av.VideoFrame:
    frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")
    if pixel_format.startswith("gbr"):
        frame = frame.reformat(format=pixel_format, interpolation=EXACT, threads=1)
    else:
        frame = frame.reformat(
            format=pixel_format,
            dst_colorspace=Colorspace.ITU601,
            dst_color_range=ColorRange.MPEG,
            interpolation=EXACT,
            threads=1,
        )
    frame.pts = index
    return frame
