"""What LeRobot must know of a video, read from the file; and whether it shows an episode's frames at their times."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import av
import av.container
import numpy as np

from vcage.base.errors import DamagedFile
from vcage.base.videos import frame_times

TIME_TOLERANCE = 1e-4
"""Seconds by which LeRobot lets a picture's time differ from its frame's, as its ``tolerance_s`` has it."""

ENCODE_AGAIN = "encode it again (in a run: compress with --force)"


def video_info(path: Path, frames: int, fps: float) -> dict[str, Any]:
    """The ``info`` of a video feature, as in ``meta/info.json``.

    All packets are read, none is decoded: a file that is cut off is found, and one whose pictures come at other times.

    Args:
        path: an MP4 file.
        frames: how many pictures it must show.
        fps: one every ``1 / fps`` seconds, the first at 0.

    Raises:
        DamagedFile: it is no MP4 video, is cut off, or shows other frames; says which.
    """
    times = np.array(frame_times(path))
    with av.open(str(path)) as container:
        info = _stream_info(container, path)
    if len(times) != frames:
        raise DamagedFile(f"{path} has {len(times)} frames, its episode {frames}", hint=ENCODE_AGAIN)
    late = np.abs(times - np.arange(frames) / fps)
    if late.max() > TIME_TOLERANCE:
        worst = int(np.argmax(late > TIME_TOLERANCE))
        raise DamagedFile(
            f"{path} shows frame {worst} at {times[worst]:.4f} s, its episode has {fps} frames per second, "
            f"which is {worst / fps:.4f} s",
            hint=ENCODE_AGAIN,
        )
    return {**info, "video.fps": as_int(fps), "video.is_depth_map": False}


def as_int(number: float) -> int | float:
    """An int where the number is one, as LeRobot writes frame rates."""
    return int(number) if float(number).is_integer() else number


def _stream_info(container: av.container.InputContainer, path: Path) -> dict[str, Any]:
    if "mp4" not in container.format.name.split(","):
        raise DamagedFile(
            f"{path} is {container.format.long_name}, LeRobot's videos are MP4",
            hint="put the stream into an MP4 file: ffmpeg -i IN -c copy OUT.mp4",
        )
    context = container.streams.video[0].codec_context
    return {
        "video.height": context.height,
        "video.width": context.width,
        "video.channels": 3,
        "video.codec": context.codec.canonical_name,
        "video.pix_fmt": context.pix_fmt,
        "has_audio": bool(container.streams.audio),
    }
