"""Camera pictures of episodes as videos that every browser plays.

The data set's own streams are HEVC, which most browsers do not decode.
"""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np

from vcage.base.workers import cores
from vcage.datasets.reader import EpisodeReader

ENCODING: dict[str, object] = {
    "preset": "superfast",
    "crf": "27.5",
    "x264-params": "mbtree=1:rc-lookahead=10:partitions=p8x8,i8x8,i4x4:threads=1",
}
"""Of x264, H.264. What stands still gets its bits once (``mbtree``): the bytes of the preset ``veryfast`` at CRF 26 in
0.6 of its time, and 1 dB less (654 frames of 960×240). Episodes are encoded side by side, so each by one thread."""


GAP_PX = 4
"""Width of the white strip between the pictures of two cameras, which would otherwise look like one."""


@dataclass(frozen=True)
class Preview:
    """The pictures of an episode.

    Args:
        url: of the video, with its data.
        cameras: that are seen in it, from left to right.
    """

    url: str
    cameras: list[str]


def previews(episodes: Sequence[tuple[Path, float]]) -> list[Preview | None]:
    """Show all cameras of each episode side by side; None for an episode without pictures.

    Args:
        episodes: the file of each, and its frames per second.

    Raises:
        DamagedFile: an episode or its video cannot be read.
    """
    with ThreadPoolExecutor(cores()) as pool:
        return list(pool.map(lambda one: _preview(*one), episodes))


def _preview(path: Path, fps: float) -> Preview | None:
    with EpisodeReader(path) as reader:
        if not reader.cameras:
            return None
        tracks = [reader.images(camera) for camera in reader.cameras]
        video = browser_video(map(side_by_side, zip(*tracks, strict=True)), fps)
        return Preview(video_url(video), list(reader.cameras))


def side_by_side(pictures: Sequence[np.ndarray]) -> np.ndarray:
    """Join (H, W, 3) uint8 pictures of cameras from left to right, with :data:`GAP_PX` of white between them."""
    gap = np.full((pictures[0].shape[0], GAP_PX, 3), 255, np.uint8)
    return np.concatenate([part for picture in pictures for part in (gap, picture)][1:], axis=1)


def video_url(video: bytes) -> str:
    """Return an MP4 as a data URL."""
    return "data:video/mp4;base64," + base64.b64encode(video).decode()


def browser_video(frames: Iterable[np.ndarray], fps: float) -> bytes:
    """Return an MP4 that every browser plays.

    Args:
        frames: (H, W, 3) uint8 RGB each.
        fps: frames per second.
    """
    buffer = io.BytesIO()
    with av.open(buffer, "w", format="mp4") as container:
        stream = None
        for frame in frames:
            if stream is None:
                stream = container.add_stream("libx264", rate=Fraction(fps).limit_denominator(1000))
                stream.height, stream.width = frame.shape[0] // 2 * 2, frame.shape[1] // 2 * 2
                stream.pix_fmt = "yuv420p"
                stream.options = ENCODING
            even = cv2.cvtColor(frame[: stream.height, : stream.width], cv2.COLOR_RGB2YUV_I420)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(np.asarray(even, np.uint8), format="yuv420p")))
        if stream is not None:
            container.mux(stream.encode())
    return buffer.getvalue()
