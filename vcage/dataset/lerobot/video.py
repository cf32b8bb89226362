"""What LeRobot must know of a video, read from the file; and whether it shows an episode's frames at their times."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import av
import av.container
import numpy as np

from vcage.errors import DamagedFile

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
    try:
        with av.open(str(path)) as container:
            times = _times(container, path)
            info = _stream_info(container, path)
    except (av.error.FFmpegError, OSError) as error:
        raise DamagedFile(f"{path} is not a video: {error}", hint=ENCODE_AGAIN) from error
    if len(times) != frames:
        raise DamagedFile(f"{path} has {len(times)} frames, its episode {frames}", hint=ENCODE_AGAIN)
    late = np.abs(np.sort(times) - np.arange(frames) / fps)
    if late.max() > TIME_TOLERANCE:
        worst = int(np.argmax(late > TIME_TOLERANCE))
        raise DamagedFile(
            f"{path} shows frame {worst} at {np.sort(times)[worst]:.4f} s, its episode has {fps} frames per second, "
            f"which is {worst / fps:.4f} s",
            hint=ENCODE_AGAIN,
        )
    return {**info, "video.fps": whole(fps), "video.is_depth_map": False}


def whole(number: float) -> int | float:
    """An int where the number is one, as LeRobot writes frame rates."""
    return int(number) if float(number).is_integer() else number


def _times(container: av.container.InputContainer, path: Path) -> list[float]:
    """Seconds at which the pictures are shown, in the order of the file."""
    if not container.streams.video:
        raise DamagedFile(f"{path} is not a video: it has no stream of pictures", hint=ENCODE_AGAIN)
    times: list[float] = []
    for packet in container.demux(container.streams.video[0]):
        if packet.size == 0 or packet.is_discard:  # what ends the stream, and what an edit list leaves out
            continue
        if packet.is_corrupt or packet.pts is None:
            raise DamagedFile(f"{path} is cut off or damaged at frame {len(times)}", hint=ENCODE_AGAIN)
        times.append(float(packet.pts * packet.time_base))
    return times


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
