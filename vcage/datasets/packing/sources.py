"""The recordings at a path, named and checked before any work."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

from vcage.base.errors import (
    DamagedFile,
    InputFileError,
    OutputFolderError,
    OversizedFile,
    UnknownName,
    UsageError,
)
from vcage.base.files import sha256_file
from vcage.base.folders import natural_key, real_path, require_utf8
from vcage.base.memory import free_memory
from vcage.base.text import listed
from vcage.datasets.packing.clips import Clip
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.recordings.colours import AUTO
from vcage.datasets.recordings.opening import open_all
from vcage.datasets.recordings.recording import Recording, relative_name
from vcage.video.codec import formats_for


@dataclass(frozen=True)
class SourceRecording:
    """One recording to be compressed.

    Args:
        name: unique among them; the file's, and the demonstration where the file holds several, or the episode.
        file: the recording's path without suffix, relative to the input; shared by the demonstrations of a file.
        recording: the recording.
        notes: for the user, on how it was understood.
        failed: why it is no demonstration of its task, if it says so.
        unclear: the error of a label that tells neither failure nor success.
    """

    name: str
    file: str
    recording: Recording
    notes: tuple[str, ...] = ()
    failed: str | None = None
    unclear: DamagedFile | None = None


@dataclass(frozen=True)
class Sources:
    """Recordings at a path.

    Args:
        root: the path.
        sources: the usable recordings, in order; at least one.
        damaged: name → error of the damaged ones left out.
        failed: name → why the ones left out are no demonstrations of their task.
        passed_over: file or folder at the path that is not read → description.
    """

    root: Path
    sources: Sequence[SourceRecording]
    damaged: dict[str, str]
    failed: dict[str, str] = field(default_factory=dict)
    passed_over: Mapping[str, str] = field(default_factory=dict)

    def clips(self, cameras: Sequence[str] = (), fps: float | None = None, *, commanded: bool = False) -> list[Clip]:
        """Return every camera of every recording, or those named.

        Args:
            cameras: their names; empty for all.
            fps: for recordings that do not say.
            commanded: only the frames that have a command.

        Raises:
            UnknownName: a recording has no such camera.
            UsageError: it has depth or labels; or neither the recording nor ``fps`` states the frame rate.
        """
        clips = []
        for source in self.sources:
            recording = source.recording
            there = [camera.name for camera in recording.cameras]
            if unknown := [camera for camera in cameras if camera not in there]:
                raise _no_camera(recording, unknown[0])
            rate = rate_of(recording, fps)
            if rate is None:
                message = f"{recording} does not say how many frames per second it has"
                raise UsageError(message, hint=recording.rate_hint)
            window = recording.commanded if commanded else None
            clips += [Clip(source.name, recording, camera, rate, window) for camera in cameras or there]
        return clips

    def hashes(self) -> dict[str, str]:
        """Return name → SHA-256 of the recording's file; of several files, that of their names and digests."""
        digest = cache(sha256_file)  # episodes of a data set share files
        folder = self.root if self.root.is_dir() else self.root.parent
        found = {}
        for source in self.sources:
            files = source.recording.files
            listing = "\n".join(f"{Path(os.path.relpath(file, folder)).as_posix()} {digest(file)}" for file in files)
            found[source.name] = digest(files[0]) if len(files) == 1 else hashlib.sha256(listing.encode()).hexdigest()
        return found

    def missing_cameras(self) -> dict[str, list[str]]:
        """Return name → cameras it lacks and another has, of recordings that lack any."""
        cameras = {source.name: {camera.name for camera in source.recording.cameras} for source in self.sources}
        every = set().union(*cameras.values())
        return {name: sorted(every - own, key=natural_key) for name, own in cameras.items() if own != every}

    def without(self, name: str, complaint: str) -> Sources:
        """Return the others than a source that turned out to be damaged.

        Raises:
            DamagedFile: it is the last.
        """
        left = [source for source in self.sources if source.name != name]
        damaged = {**self.damaged, name: complaint}
        if not left:
            raise DamagedFile("; ".join(damaged.values()), hint="none is sound", details={"damaged": damaged})
        return replace(self, sources=left, damaged=damaged)

    def failures(self) -> dict[str, str]:
        """Return name → why a recording is no demonstration of its task, for those marked so."""
        return self.failed or {source.name: source.failed for source in self.sources if source.failed is not None}

    def without_failed(self, *, skip_damaged: bool = False) -> Sources:
        """Return the recordings not marked as failed.

        Args:
            skip_damaged: leave out those with an unclear label, too, instead of refusing all.

        Raises:
            DamagedFile: a label is unclear.
            InputFileError: all failed.
        """
        unclear = {source.name: source.unclear for source in self.sources if source.unclear is not None}
        clear = [source for source in self.sources if source.unclear is None]
        if unclear and not (skip_damaged and clear):
            raise _refusal(unclear, left=len(clear))
        failed = {source.name: source.failed for source in clear if source.failed is not None}
        left = [source for source in clear if source.failed is None]
        if not left:
            raise InputFileError(
                f"{self.root} holds failed demonstrations only ({len(failed)}: {next(iter(failed.values()))})",
                hint=f"give --to {self.sources[0].recording.TARGET}, which keeps them unchanged and marked as failed",
                details={"failed": failed},
            )
        damaged = self.damaged | {name: error.message for name, error in unclear.items()}
        return replace(self, sources=left, failed=failed, damaged=damaged)


def rate_of(recording: Recording, fps: float | None) -> float | None:
    """Return frames per second: stated by the recording, else by the user, else by timestamps."""
    return recording.fps or fps or recording.rate_guess


def find_sources(
    root: Path, settings: CompressionSettings, *, skip_damaged: bool = False, colours: str = AUTO
) -> Sources:
    """Open all recordings at a path, and check them as far as possible without decoding.

    Args:
        root: a file or a folder.
        settings: of the encoding.
        skip_damaged: leave out damaged ones, with a note, instead of refusing all.
        colours: see :func:`vcage.datasets.recordings.opening.open_all`.

    Raises:
        InputFileError: there is nothing at the path, or nothing known.
        DamagedFile: a recording is damaged; names the first few, and how many there are.
        UsageError: a recording has no pictures, or of a size that the codec or the pixel format does not take, or two
            recordings would be written under one name.
    """
    root = Path(root)
    opened = open_all(root, colours)
    complaints = {relative_name(path, root): error for path, error in opened.damaged.items()}
    sources: dict[str, SourceRecording] = {}
    _require_own_names(opened.recordings, root)
    memory = free_memory()
    for recording in opened.recordings:
        name = recording.name(root)
        try:
            notes, (failed, unclear) = sound_notes(recording), recording.outcome()
            _require_encodable(recording, settings)
            _require_memory(recording, memory)
        except DamagedFile as error:
            complaints[name] = error
        else:
            notes += [unclear.details["note"]] if unclear else []
            file = relative_name(recording.path, root)
            sources[name] = SourceRecording(name, file, recording, tuple(notes), failed, unclear)
    if complaints and not (skip_damaged and sources):
        raise _refusal(complaints, left=len(sources))
    damaged = {name: error.message for name, error in complaints.items()}
    return Sources(root, list(sources.values()), damaged, passed_over=opened.passed_over)


def _require_own_names(recordings: Sequence[Recording], root: Path) -> None:
    """Raise UsageError where two recordings would be written under one name."""
    taken: dict[str, Recording] = {}
    for recording in recordings:
        for written in (relative_name(recording.path, root), recording.name(root)):
            first = taken.setdefault(written, recording)
            if first.path != recording.path:
                raise UsageError(
                    f"{first} and {recording} would both be written as {written}", hint="rename one of them"
                )


def require_apart(root: Path, out: Path) -> None:
    """Require that recordings and output do not lie in one another.

    Raises:
        OutputFolderError: one lies in the other, or the output's path is not UTF-8.
        InputFileError: that of the recordings is not.
    """
    root, out = real_path(root), real_path(out)
    require_utf8(root)
    require_utf8(out, OutputFolderError)
    if out == root or out in root.parents or root in out.parents:
        raise OutputFolderError(
            f"{out} and the recordings in {root} lie in one another",
            hint="give an --out beside them: the recordings are never changed",
        )


def sound_notes(recording: Recording) -> list[str]:
    """Return notes for the user on how a sound recording was understood.

    Raises:
        DamagedFile: its commands are not finite numbers, one row for each picture, or a camera has no picture.
    """
    notes = list(recording.notes)
    for camera in recording.cameras:
        if camera.frames == 0:
            raise DamagedFile(f"{recording}: {camera.name} holds no frame", hint="leave the episode out")
    return notes


def _require_encodable(recording: Recording, settings: CompressionSettings) -> None:
    if not recording.cameras and recording.other_streams:
        raise InputFileError(
            f"{recording} holds no camera's pictures, only {', '.join(map(str, recording.other_streams))}",
            hint="leave it unchanged: videos are for colours, and would change these numbers",
        )
    if not recording.cameras:
        raise UsageError(f"{recording} holds no pictures", hint="leave it out: there is nothing to compress")
    for camera in recording.cameras:
        try:
            formats_for(settings.choices().settings(), camera.width, camera.height, settings.pixel_formats)
        except UsageError as error:
            raise UsageError(f"{recording}, {camera.name}: {error.message}", hint=error.hint) from error


def _require_memory(recording: Recording, free: int) -> None:
    """Raise OversizedFile where the pictures of a camera, which are all read together, exceed the free memory."""
    for camera in recording.cameras:
        if camera.raw_bytes > free > 0:
            raise OversizedFile(
                f"{recording}, {camera.key}: {camera.frames:,} pictures of {camera.width} x {camera.height} take "
                f"{camera.raw_bytes:,} bytes; {free:,} bytes of memory are free",
                hint="split the recording, or use a machine with more memory",
            )


def _no_camera(recording: Recording, name: str) -> UsageError:
    for stream in recording.other_streams:
        if name == stream.key.rpartition("/")[2]:
            return UsageError(
                f"{recording}: {stream} is no camera, and no 8-bit video keeps it",
                hint="leave it out of --cameras: in HDF5 it stays unchanged",
            )
    return UnknownName(f"camera of {recording}", name, [camera.name for camera in recording.cameras])


def _refusal(complaints: Mapping[str, DamagedFile], left: int) -> DamagedFile:
    """Return one error of all complaints, when ``left`` recordings are sound."""
    messages = {name: error.message for name, error in complaints.items()}
    every = list(dict.fromkeys(messages.values()))  # many may complain of one file that describes them
    hint = next(iter(complaints.values())).hint
    if left:
        hint = f"fix or remove what is damaged, or go on without it: --skip-damaged (sound: {left})"
    return DamagedFile(listed(every, most=5, between="; "), hint=hint, details={"damaged": messages})
