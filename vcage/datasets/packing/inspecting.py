"""What recordings hold, without decoding more than a few pictures of them."""

from __future__ import annotations

from collections import Counter
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
from vcage.datasets.recordings.recording import HDF5, VIDEOS, Recording

MIB = 2**20


@dataclass(frozen=True)
class Inspected:
    """A recording, or what is wrong with it.

    Args:
        name: the path, and the episode where a path holds several.
        recording: None where the file is damaged.
        damage: what is wrong; empty where nothing is.
        passed_over: what it is, where it is no recording and is not read; empty otherwise.
        notes: what a user must know about how it was understood.
        left_out: what a LeRobot data set does not get of it: key → reason.
        failed: why it is no demonstration of its task, if it says so.
    """

    name: str
    recording: Recording | None
    damage: str = ""
    passed_over: str = ""
    notes: tuple[str, ...] = ()
    left_out: Mapping[str, str] = field(default_factory=dict)
    failed: str | None = None

    @property
    def cameras(self) -> Sequence[RecordedCamera]:
        """Those of a sound recording."""
        return self.recording.cameras if self.recording is not None else []


def inspect(root: Path, colours: str = AUTO) -> list[Inspected]:
    """All recordings at a path, the damaged ones too.

    Args:
        root: the path.
        colours: see :func:`vcage.datasets.recordings.opening.open_all`.

    Raises:
        InputFileError: there is nothing at the path, or nothing that is known.
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
    """The recordings as lines for people."""
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
        return [f"{found.name}: DAMAGED: {found.damage}"]
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
        f"{camera.stored_bytes / MIB:.1f} MiB ({saved:.1%} smaller than raw)"
    )


def totals(found: Sequence[Inspected]) -> dict[str, Any]:
    """The recordings in numbers."""
    cameras = [camera for one in found for camera in one.cameras]
    sound = [one.recording for one in found if one.recording is not None]
    others = Counter(stream for recording in sound for stream in recording.other_streams)
    return {
        "recordings": sum(one.recording is not None for one in found),
        "layouts": sorted({one.recording.LAYOUT for one in found if one.recording is not None}),
        "cameras": sorted({camera.name for camera in cameras}, key=natural_key),
        "frames": sum(camera.frames for camera in cameras),
        "raw_bytes": sum(camera.raw_bytes for camera in cameras),
        "stored_bytes": sum(camera.stored_bytes for camera in cameras),
        "colours": as_json(colour_orders(recording.colours for recording in sound)),
        "other_streams": [
            {"stream": stream.key, "shows": stream.shows, "stored": stream.stored, "recordings": count}
            for stream, count in others.items()
        ],
        "damaged": {one.name: one.damage for one in found if one.damage},
        "passed_over": {one.name: one.passed_over for one in found if one.passed_over},
        "notes": {one.name: list(one.notes) for one in found if one.notes},
        "left_out": _left_out(found),
        "failed": failures({one.name: one.failed for one in found if one.failed is not None}),
    }
