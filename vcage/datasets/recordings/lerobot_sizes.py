"""Sizes of LeRobot's pictures, as the data set states them, and of its files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import av

from vcage.base.errors import DamagedFile
from vcage.base.placeholders import require_fetched
from vcage.base.video_files import open_video
from vcage.datasets.lerobot.parquet import MEND

CHANNELS = (1, 3, 4)
"""Of a picture; what tells them from its height and width."""


def picture_size(shape: Sequence[int]) -> tuple[int, int]:
    """Height and width of pictures whose channels come last, as LeRobot has them, or first."""
    first = len(shape) == 3 and shape[0] in CHANNELS and shape[2] not in CHANNELS
    height, width = shape[1:] if first else shape[:2]
    return height, width


def file_size(file: Path) -> int:
    """Bytes of a file.

    Raises:
        DamagedFile: it is missing, or was not fetched.
    """
    require_fetched(file)
    try:
        return file.stat().st_size
    except OSError as error:
        raise DamagedFile(f"{file} is missing", hint=MEND) from error


def video_seconds(file: Path) -> float:
    """Duration of a video.

    Raises:
        DamagedFile: it is missing or no video.
    """
    file_size(file)
    with open_video(file) as container:
        return float(container.duration or 0) / av.time_base
