"""A picture of a recording's frames, for users to check that red and blue are where they belong."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from vcage.base.drawing import contact_sheet
from vcage.base.errors import DiskFull, OutputFolderError
from vcage.base.files import cache_path
from vcage.base.pictures import write_picture
from vcage.datasets.recordings.recording import Recording

logger = logging.getLogger(__name__)

FRAMES = "frames.png"
"""Its name in the output."""


def write_frames(path: Path, recordings: Sequence[Recording], most_cameras: int = 8) -> Path | None:
    """Write a frame of each camera whose colours are not sure, as it is read and with red and blue changed.

    Args:
        path: the PNG file.
        recordings: the first with a camera of a name stands for all.
        most_cameras: rows of the picture.

    Returns:
        The path; None where all is sure, and nothing is written.

    Raises:
        DamagedFile: a picture cannot be read.
        OutputFolderError, DiskFull: it cannot be written.
    """
    views: dict[str, np.ndarray] = {}
    for recording in recordings:
        if recording.colours is None or recording.colours.sure:
            continue
        for camera in recording.cameras:
            if camera.name not in views and len(views) < most_cameras:
                views[camera.name] = recording.pictures(camera.name, [camera.frames // 2])[0]
    if not views:
        return None
    sheet: list[tuple[str, np.ndarray]] = []
    for name, picture in views.items():
        sheet.append((f"{name} as it is read", np.ascontiguousarray(picture)))
        sheet.append((f"{name} with red and blue changed", np.ascontiguousarray(picture[..., ::-1])))
    return write_picture(path, contact_sheet(sheet))


def show_frames(root: Path, recordings: Sequence[Recording]) -> Path | None:
    """Write the picture into the user's cache, for recordings found at ``root``; see :func:`write_frames`."""
    name = hashlib.sha256(str(root.resolve()).encode()).hexdigest()[:16]
    try:
        return write_frames(cache_path("frames") / f"{name}.png", recordings)
    except (OutputFolderError, DiskFull) as error:
        logger.warning("no picture of frames is shown: %s", error.message)
        return None


def as_text(path: Path | None) -> str | None:
    """Return a path for a summary."""
    return None if path is None else str(path)
