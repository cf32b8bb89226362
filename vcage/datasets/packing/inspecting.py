"""Content of recordings, known without decoding more than a few pictures of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from vcage.base.errors import DamagedFile
from vcage.base.folders import natural_key
from vcage.base.text import listed
from vcage.datasets.packing.output import failures
from vcage.datasets.packing.sources import sound_notes
from vcage.datasets.recordings.cameras import RecordedCamera
from vcage.datasets.recordings.colours import AUTO, as_json, colour_orders
from vcage.datasets.recordings.opening import open_all
from vcage.datasets.recordings.other_streams import stream_counts
from vcage.datasets.recordings.recording import HDF5, VIDEOS, Recording


@dataclass(frozen=True)
class Inspected:
    """A recording, or its error.

    Args:
        name: the path, and the episode where a path holds several.
        recording: None where the file is damaged.
        damaged: the error; empty where there is none.
        passed_over: description of a file that is no recording and is not read; empty otherwise.
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
