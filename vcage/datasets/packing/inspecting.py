"""Content of recordings, known without decoding more than a few pictures of them."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from vcage.base.drawing import contact_sheet
from vcage.base.errors import DamagedFile, DiskFull, OutputFolderError
from vcage.base.files import cache_path
from vcage.base.folders import natural_key
from vcage.base.pictures import write_picture
from vcage.base.text import listed
from vcage.datasets.packing.output import failures
from vcage.datasets.packing.sources import sound_notes
from vcage.datasets.recordings.colours import AUTO, as_json, colour_orders
from vcage.datasets.recordings.opening import open_all
from vcage.datasets.recordings.recording import HDF5, VIDEOS, Recording
from vcage.datasets.recordings.streams import RecordedCamera, stream_counts

logger = logging.getLogger(__name__)

FRAMES = "frames.png"
"""Its name in the output."""


def write_frames(path: Path, recordings: Sequence[Recording], most_cameras: int = 8) -> Path | None:
    """Write a frame of each camera with unsure colours, as read and with red and blue swapped.

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


@dataclass(frozen=True)
class Inspected:
    """A recording, or its error.

    Args:
        name: the path, and the episode where a path holds several.
        recording: None where the file is damaged.
        damaged: the error; empty where there is none.
        passed_over: description of a skipped file that is no recording; empty otherwise.
        notes: for the user, on how it was understood.
        left_out: data that a LeRobot data set does not get: key → reason.
        failed: why it is no demonstration of its task, if it says so.
    """

    name: str
    recording: Recording | None
    damaged: str = ""
    passed_over: str = ""
    notes: tuple[str, ...] = ()
    left_out: Mapping[str, str] = field(default_factory=dict)
    failed: str | None = None

    @property
    def cameras(self) -> Sequence[RecordedCamera]:
        """Cameras of a sound recording."""
        return self.recording.cameras if self.recording is not None else []


def inspect(root: Path, colours: str = AUTO) -> list[Inspected]:
    """Return all recordings at a path, the damaged ones too.

    Args:
        root: the path.
        colours: see :func:`vcage.datasets.recordings.opening.open_all`.

    Raises:
        InputFileError: there is nothing at the path, or nothing known.
    """
    opened = open_all(Path(root), colours)
    found = [_look(recording) for recording in opened.recordings]
    found += [Inspected(str(path), None, error.message) for path, error in opened.damaged.items()]
    return found + [Inspected(name, None, passed_over=what) for name, what in opened.passed_over.items()]


def _look(recording: Recording) -> Inspected:
    try:
        stays = {HDF5: "it stays as it is in HDF5, and is left out of all else", VIDEOS: "left out"}
        becomes = stays.get(recording.TARGET, "it stays as it is in the same version, and is left out of all else")
        others = (f"{stream} is no camera: {becomes}" for stream in recording.other_streams)
        notes = (*sound_notes(recording), *others)
        failed, unclear = recording.outcome()
        notes += (unclear.details["note"],) if unclear else ()
        return Inspected(str(recording), recording, notes=notes, left_out=recording.left_out(), failed=failed)
    except DamagedFile as error:
        return Inspected(str(recording), None, error.message)


def as_lines(found: Sequence[Inspected]) -> str:
    """Return lines on the recordings for people."""
    lines = [line for one in found for line in _lines(one)]
    if left_out := _left_out(found):
        is_one = any(one.recording is not None and one.recording.TARGET not in (HDF5, VIDEOS) for one in found)
        lines.append(f"not for a LeRobot data set{' of another version' * is_one}: {listed(left_out)}")
    return "\n".join(lines)


def _left_out(found: Sequence[Inspected]) -> dict[str, str]:
    return {key: why for one in reversed(found) for key, why in one.left_out.items()}


def _lines(found: Inspected) -> list[str]:
    recording = found.recording
    if found.passed_over:
        return [f"{found.name} is not read: {found.passed_over}"]
    if recording is None:
        return [f"{found.name}: DAMAGED: {found.damaged}"]
    rate = f"{recording.fps:g} fps" if recording.fps else "fps not said"
    motion = recording.motion
    numbers = f"{motion.values.shape[1]} numbers in a command" if motion is not None else "no commands"
    lines = [f"{found.name}: {recording.LAYOUT}, {rate}, {numbers}"]
    lines += [f"  {_camera(camera)}" for camera in recording.cameras]
    if found.failed is not None:
        lines.append(f"  failed: {found.failed}")
    return lines + [f"  note: {note}" for note in found.notes]


def _camera(camera: RecordedCamera) -> str:
    saved = 1 - camera.stored_bytes / max(camera.raw_bytes, 1)
    return (
        f"{camera.name}: {camera.frames} frames of {camera.width}x{camera.height}, {camera.storage}, "
        f"{camera.stored_bytes / 2**20:.1f} MiB ({saved:.1%} smaller than raw)"
    )


def totals(found: Sequence[Inspected]) -> dict[str, Any]:
    """Return figures of the recordings, JSON-serialisable."""
    cameras = [camera for one in found for camera in one.cameras]
    sound = [one.recording for one in found if one.recording is not None]
    return {
        "recordings": len(sound),
        "layouts": sorted({recording.LAYOUT for recording in sound}),
        "cameras": sorted({camera.name for camera in cameras}, key=natural_key),
        **{name: sum(getattr(camera, name) for camera in cameras) for name in ("frames", "raw_bytes", "stored_bytes")},
        "colours": as_json(colour_orders(recording.colours for recording in sound)),
        "other_streams": stream_counts(recording.other_streams for recording in sound),
        **{name: _stated(found, name) for name in ("damaged", "passed_over")},
        "notes": {name: list(notes) for name, notes in _stated(found, "notes").items()},
        "left_out": _left_out(found),
        "failed": failures(_stated(found, "failed")),
    }


def _stated(found: Sequence[Inspected], field: str) -> dict[str, Any]:
    return {one.name: value for one in found if (value := getattr(one, field))}
