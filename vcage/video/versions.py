"""Which build of an encoder is at work: other versions give other bytes for the same CRF, so results name it."""

from __future__ import annotations

import io
import re
from functools import cache

import av
import numpy as np

from vcage.video.encoders import CODECS, Codec, require_encoder

SIDE = 32

PATTERNS = {"hevc": rb"x265 \(build \d+\) - ([\w.+-]+)", "h264": rb"x264 - (core \d+(?: r\d+ \w+)?)"}
"""Codec → where its encoder's message in the stream (user data SEI) names the version."""


@cache
def encoder_version(codec: str) -> str:
    """The version of a codec's encoder as it writes it into its streams, with that of libavcodec.

    SVT-AV1 leaves no such message; then libavcodec's version alone stands for the build.

    Raises:
        MissingDependency: this build of PyAV lacks the encoder.
    """
    facts = CODECS[codec]
    require_encoder(facts)
    library = "libavcodec " + ".".join(map(str, av.library_versions["libavcodec"]))
    pattern = PATTERNS.get(codec)
    found = re.search(pattern, _stream_with_message(facts)) if pattern else None
    return f"{found[1].decode()}, {library}" if found else library


def _stream_with_message(codec: Codec) -> bytes:
    target = io.BytesIO()
    with av.open(target, "w", format=codec.name) as container:  # without a container, in which nothing is searched
        stream = container.add_stream(codec.encoder, rate=1)
        stream.height = stream.width = SIDE
        stream.pix_fmt = "yuv420p"
        stream.options = {"x265-params": "info=1:log-level=none"} if codec.name == "hevc" else {}
        grey = av.VideoFrame.from_ndarray(np.full((SIDE, SIDE, 3), 128, np.uint8), format="rgb24")
        container.mux(stream.encode(grey))
        container.mux(stream.encode(None))
    return target.getvalue()
