"""PyAV's encoders, and their options for preset, GOP and quality."""

from __future__ import annotations

import io
import os
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import cast

import av
import numpy as np

from vcage.base.commands import pip_command
from vcage.base.errors import MissingDependency
from vcage.schema.compression import Effort

EncoderOptions = dict[str, str]

PATTERNS = {"hevc": rb"x265 \(build \d+\) - ([\w.+-]+)", "h264": rb"x264 - (core \d+(?: r\d+ \w+)?)"}
"""Codec → pattern of the version in its encoder's message in the stream (user data SEI)."""

_QUICK: dict[str, str | int] = {
    "rd": 2,
    "me": "dia",
    "subme": 1,
    "max-merge": 1,
    "ref": 1,
    "tu-inter-depth": 1,
    "tu-intra-depth": 1,
    "rect": 1,
    "limit-modes": 1,
}
X265_EFFORTS: dict[Effort, dict[str, str | int]] = {
    "fast": {**_QUICK, "min-cu-size": 16},
    "default": _QUICK,
    "best": {"rect": 1, "tu-inter-depth": 2, "tu-intra-depth": 2},
}
"""Effort of x265: exactness of the cost of a choice, search range of a block's motion, and depth and shapes of the
splits of blocks and their transforms.

Measured on three clips of 320x240 at the same loss, in the encoder's own time: against exact weighing, a wider look and
transforms split twice, ``default`` takes an eighth more bytes in seven tenths of the time. Without rectangular blocks
it would be another seventh, and with no block smaller than 16 pixels it is half as many bytes again in less than half
the time. ``python -m benchmarks compression --efforts`` compares the efforts."""


@dataclass(frozen=True)
class Codec:
    """One codec and its encoder.

    Args:
        name: FFmpeg's name of the codec.
        encoder: FFmpeg's name of the encoder.
        tag: of the stream in MP4.
        presets: effort → the encoder's preset.
        pixel_formats: that a search may choose from, the best first.
        other_formats: available on request. Measured on rendered episodes: 8 bits take more bytes than 10 at
            the same loss, and RGB twice those of 4:4:4, so that a search need not try them.
        max_crf: the worst quality.
        min_crf: the best; 0, unless that means something else to the encoder.
        first_crf: where a search begins.
        options: (effort, preset, gop, crf) → the encoder's options; a CRF of None asks for no loss.
        causal: true if the encoding of a frame does not depend on frames before its group of pictures or after it, so
            that a :class:`vcage.video.judge.Excerpt` has the losses of the whole video.
        lossless_format: pixel format of RGB without loss; empty where there is none.
        lossless_encoder: the encoder for it.
    """

    name: str
    encoder: str
    tag: str
    presets: Mapping[Effort, str]
    pixel_formats: tuple[str, ...]
    other_formats: tuple[str, ...]
    max_crf: int
    first_crf: int
    options: Callable[[Effort, str, int, int | None], EncoderOptions]
    causal: bool = False
    min_crf: int = 0
    lossless_format: str = ""
    lossless_encoder: str = ""


def _x265(effort: Effort, preset: str, gop: int, crf: int | None) -> EncoderOptions:
    params: Mapping[str, str | int] = {
        **X265_EFFORTS[effort],
        "keyint": gop,
        "min-keyint": gop,
        "scenecut": 0,
        "open-gop": 0,  # an open GOP gives wrong frames after a seek
        "cutree": 0,  # measured: a quarter fewer bytes at 0.1 JOD in the worst frame, for cutree starves it
        "sao": 0,  # measured: a quarter less time for 2 % more bytes
        # Measured on rendered episodes at 0.1 JOD in the worst frame: a third fewer bytes with the three of these, in
        # no more time. The worst frame would be a B-frame, or one in which much moves and steps were coarser.
        "bframes": 0,
        "qcomp": 1,
        "aq-mode": 1,  # measured on three clips at the same loss: 4 % fewer bytes than mode 2
        # What counts is the worst frame, never the I-frame alone.
        "ipratio": "1.0",
        # Measured on three clips of 320x240 at one loss: a tenth less time than with psy-rd, in as many bytes; and with
        # steps of colour so much coarser, 6 % fewer bytes in 4:4:4, where psy-rd itself brought them, 2 % in others.
        "psy-rd": "0.0",
        "psy-rdoq": "0.0",
        "cbqpoffs": 6,
        "crqpoffs": 6,
        # Measured on three clips of 320x240 at the same loss: 2 % fewer bytes than blocks of 64, in as much time.
        "ctu": 16,
        # Nothing depends on later frames; a frame depends on those before it in its group alone.
        "rc-lookahead": 0,
        "weightp": 0,
        "frame-threads": 1,
        "lookahead-slices": 0,
        # One thread, as there is a process for each core: rows encoded in parallel tell the entropy coder
        # less, which takes 2 % more bytes.
        "wpp": 0,
        "pools": "none",
        "info": 0,
        "log-level": "none",
        **({"lossless": 1} if crf is None else {"crf": crf}),
    }
    joined = ":".join(f"{name}={value}" for name, value in params.items())
    return {"preset": preset, "forced-idr": "1", "x265-params": joined}


def _x264(_effort: Effort, preset: str, gop: int, crf: int | None) -> EncoderOptions:
    return {
        "preset": preset,
        "g": str(gop),
        "keyint_min": str(gop),
        "sc_threshold": "0",
        "threads": "1",  # more of them change the bytes
        "x264-params": "open-gop=0",
        **({"qp": "0"} if crf is None else {"crf": str(crf)}),
    }


def _svt_av1(_effort: Effort, preset: str, gop: int, crf: int | None) -> EncoderOptions:
    return {
        "preset": preset,
        "g": str(gop),
        "crf": str(crf),
        # by FFmpeg's settings a GOP begins with a key frame, from which a reader can start; no others in between
        "svtav1-params": "enable-overlays=0:scd=0:lp=1",
    }


CODECS: dict[str, Codec] = {
    codec.name: codec
    for codec in (
        Codec(
            name="hevc",
            encoder="libx265",
            tag="hvc1",  # the tag that Apple's players ask for; all others read it too
            presets={"fast": "faster", "default": "medium", "best": "slow"},
            pixel_formats=("yuv444p10le", "yuv422p10le", "yuv420p10le"),
            other_formats=("yuv444p", "yuv420p", "gbrp"),
            max_crf=51,
            first_crf=16,
            options=_x265,
            causal=True,
            lossless_format="gbrp",
            lossless_encoder="libx265",
        ),
        Codec(
            name="h264",
            encoder="libx264",
            tag="avc1",
            presets={"fast": "veryfast", "default": "medium", "best": "veryslow"},
            pixel_formats=("yuv444p10le", "yuv422p10le", "yuv420p10le"),
            other_formats=("yuv444p", "yuv420p"),
            max_crf=51,
            first_crf=14,
            options=_x264,
            lossless_format="rgb24",
            lossless_encoder="libx264rgb",
        ),
        Codec(
            name="av1",
            encoder="libsvtav1",
            tag="av01",
            presets={"fast": "10", "default": "8", "best": "5"},
            pixel_formats=("yuv420p10le",),  # SVT-AV1 has no other chroma
            other_formats=("yuv420p",),
            max_crf=63,
            min_crf=1,  # FFmpeg takes 0 for none, and then the encoder's own
            first_crf=16,
            options=_svt_av1,
        ),
    )
}
"""By name. HEVC and H.264 know 4:4:4 and RGB, SVT-AV1 does not, and so has no form without loss."""


def require_encoder(codec: Codec) -> None:
    """Require that this build of PyAV has the codec's encoder.

    Raises:
        MissingDependency: it has not; names the encoder.
    """
    if codec.encoder not in av.codecs_available:
        raise MissingDependency(
            f"PyAV has no {codec.encoder}, which encodes {codec.name}",
            hint="take another --codec, or install PyAV again",
            command=pip_command("--force-reinstall", "--only-binary", "av", "av"),
        )


@cache
def encoder_version(codec: str) -> str:
    """Return the versions of a codec's encoder, from its streams, and of libavcodec.

    Other versions give other bytes for the same CRF, so results name it. SVT-AV1 leaves no such message; then
    libavcodec's version alone stands for the build.

    Raises:
        MissingDependency: this build of PyAV lacks the encoder.
    """
    facts = CODECS[codec]
    require_encoder(facts)
    library = "libavcodec " + ".".join(map(str, av.library_versions["libavcodec"]))
    pattern = PATTERNS.get(codec)
    found = re.search(pattern, _stream_with_message(facts)) if pattern else None
    return f"{found[1].decode()}, {library}" if found else library


def _stream_with_message(codec: Codec, side_px: int = 32) -> bytes:
    target = io.BytesIO()
    with av.open(target, "w", format=codec.name) as container:  # without a container, in which nothing is searched
        stream = cast("av.VideoStream", container.add_stream(codec.encoder, rate=1))
        stream.height = stream.width = side_px
        stream.pix_fmt = "yuv420p"
        stream.options = {"x265-params": "info=1:log-level=none"} if codec.name == "hevc" else {}
        grey = av.VideoFrame.from_ndarray(np.full((side_px, side_px, 3), 128, np.uint8), format="rgb24")
        container.mux(stream.encode(grey))
        container.mux(stream.encode(None))
    return target.getvalue()


@contextmanager
def kept_priority() -> Iterator[None]:
    """Keep the scheduling of all threads of the process while an encoder is opened inside.

    SVT-AV1, where it may (as root), gives itself and the thread that opens it real-time priority, which starves every
    other program and stays when the video is finished.
    """
    policy, priority = os.sched_getscheduler(0), os.sched_getparam(0)
    try:
        yield
    finally:
        for thread in Path("/proc/self/task").glob("*"):
            with suppress(ProcessLookupError):  # it has ended meanwhile
                if os.sched_getscheduler(int(thread.name)) != policy:
                    os.sched_setscheduler(int(thread.name), policy, priority)
