"""Video files as arrays: decoded as any reader decodes them (PyAV)."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import av
import numpy as np
from numpy.typing import NDArray

from vcage.errors import DamagedFile, UsageError


def decode(video: bytes | Path, indices: Sequence[int] | None = None) -> NDArray[np.uint8]:
    """Decode from the start, as any reader does, and return the pictures at ``indices`` (None: all).

    Returns:
        (N, H, W, 3) uint8 RGB in the order of time.

    Raises:
        DamagedFile: it is no video, or is cut off.
        UsageError: an index lies outside the video.
    """
    name = str(video) if isinstance(video, Path) else "the video"
    wanted = None if indices is None else set(indices)
    pictures = []
    count = 0
    try:
        with av.open(str(video) if isinstance(video, Path) else io.BytesIO(video)) as container:
            container.streams.video[0].thread_type = "AUTO"
            for count, frame in enumerate(container.decode(video=0), start=1):
                if wanted is None or count - 1 in wanted:
                    pictures.append(frame.to_ndarray(format="rgb24"))
    except (av.error.FFmpegError, IndexError) as error:
        raise DamagedFile(
            f"{name} cannot be decoded: {error}", hint="make it again (run compress with --force), or fetch it again"
        ) from error
    if wanted and max(wanted) >= count:
        raise UsageError(f"{name} has {count} frames, frame {max(wanted)} was asked for")
    return np.stack(pictures)
