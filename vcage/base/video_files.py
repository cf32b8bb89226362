"""Video files, opened: in formats that hold their own pictures, and no larger than fits in memory."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import av

from vcage.base.errors import DamagedFile, OversizedFile
from vcage.base.pictures import LIMITS as PICTURE_LIMITS
from vcage.base.placeholders import require_fetched


@dataclass(frozen=True)
class VideoLimits:
    """The largest video that is read.

    Args:
        max_pixels: of a frame: width times height.
        max_frames: 92 hours at 30 frames per second.
    """

    max_pixels: int = PICTURE_LIMITS.max_pixels
    max_frames: int = 10_000_000


LIMITS = VideoLimits()

CONTAINERS = ",".join(("mov", "mp4", "m4a", "3gp", "3g2", "mj2", "matroska", "webm", "avi", "mpegts"))
"""FFmpeg's formats that hold their own pictures; playlists, which it knows too, name other files."""

MAKE_AGAIN = "make it again (in a run, by its stage compress), or fetch it again"


@contextmanager
def open_video(video: bytes | Path) -> Iterator[Any]:
    """PyAV's container of a file with a video stream, in a format that holds its own pictures.

    Raises:
        DamagedFile: the file is not a video, or an operation shows that it is damaged.
        OversizedFile: its frames are too large, or too many.
    """
    source: Any = io.BytesIO(video) if isinstance(video, bytes) else str(video.absolute())
    if isinstance(video, Path):
        require_fetched(video)
    try:
        with av.open(source, options={"format_whitelist": CONTAINERS}) as container:
            if not container.streams.video:
                raise DamagedFile(f"{video_name(video)} holds no video stream", hint=MAKE_AGAIN)
            _require_modest(container.streams.video[0], video_name(video), LIMITS)
            yield container
    except av.error.FFmpegError as error:
        raise DamagedFile(f"{video_name(video)} cannot be decoded: {error}", hint=MAKE_AGAIN) from error


def _require_modest(stream: Any, name: str, limits: VideoLimits) -> None:
    context = stream.codec_context
    context.options = {"max_pixels": str(limits.max_pixels)}  # frames may be larger than the header says
    if context.width * context.height > limits.max_pixels or stream.frames > limits.max_frames:
        raise OversizedFile(
            f"{name} is too large: it declares {stream.frames:,} frames of {context.width} x {context.height}; at most "
            f"{limits.max_frames:,} frames of {limits.max_pixels:,} pixels are read",
            hint="scale it down or split it, or leave the recording out",
            details={"path": name, "frames": stream.frames, "width": context.width, "height": context.height},
        )


def frame_size(video: bytes | Path) -> tuple[int, int]:
    """Height and width of the frames, pixels, read without decoding them.

    Raises:
        DamagedFile, OversizedFile: see :func:`open_video`.
    """
    with open_video(video) as container:
        context = container.streams.video[0].codec_context
        return context.height, context.width


def video_name(video: bytes | Path) -> str:
    """Name a video file, or the content of one, in messages."""
    return "the video" if isinstance(video, bytes) else str(video)
