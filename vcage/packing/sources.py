"""The recordings of a path, named, and looked at before any work is done on them."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from vcage.compression.codec import formats_for
from vcage.dataset.recordings.lerobot_layouts import LeRobotRecording
from vcage.dataset.recordings.opening import open_recordings
from vcage.dataset.recordings.recording import Recording
from vcage.errors import DamagedFile, UnknownName, UsageError
from vcage.files import sha256_file
from vcage.packing.clips import Clip
from vcage.packing.settings import CompressionSettings

LISTED = 5
"""Complaints that one message names."""


@dataclass(frozen=True)
class Source:
    """One recording to be compressed.

    Args:
        name: unique among them; a path without suffix, relative to what was given.
        recording: the recording.
    """

    name: str
    recording: Recording


@dataclass(frozen=True)
class Sources:
    """What was found at a path.

    Args:
        root: the path.
        sources: what can be used, in order; at least one.
        damaged: name → what is wrong with those that were left out.
    """

    root: Path
    sources: Sequence[Source]
    damaged: dict[str, str]

    @property
    def layouts(self) -> list[str]:
        """The layouts that were found."""
        return sorted({source.recording.LAYOUT for source in self.sources})

    def clips(self, cameras: Sequence[str] = (), fps: float | None = None) -> list[Clip]:
        """Every camera of every recording, or those named.

        Args:
            cameras: their names; none for all.
            fps: for recordings that do not say.

        Raises:
            UnknownName: a recording has no such camera.
            UsageError: neither the recording nor ``fps`` says how fast the pictures follow each other.
        """
        clips = []
        for source in self.sources:
            there = [camera.name for camera in source.recording.cameras]
            for camera in cameras:
                if camera not in there:
                    raise UnknownName(f"camera of {source.recording}", camera, there)
            rate = source.recording.fps or fps
            if rate is None:
                raise UsageError(
                    f"{source.recording} does not say how many frames per second it has", hint="give --fps N"
                )
            clips += [Clip(source.name, source.recording, camera, rate) for camera in cameras or there]
        return clips

    def hashes(self) -> dict[str, str]:
        """Name → SHA-256 of the file; of a folder, of the names and sizes of its files."""
        return {source.name: _digest(source.recording.path) for source in self.sources}


def find_sources(root: Path, settings: CompressionSettings, *, skip_damaged: bool = False) -> Sources:
    """Open all recordings at a path, and look at what can be seen without decoding them.

    Args:
        root: a file or a folder.
        settings: how they are to be encoded.
        skip_damaged: leave out those that are damaged, and say so, instead of refusing all.

    Raises:
        InputFileError: there is nothing at the path, or nothing that is known.
        DamagedFile: a recording is damaged; names the first few, and how many there are.
        UsageError: pictures are of a size that the codec does not take.
    """
    root = Path(root)
    damaged: dict[Path, DamagedFile] = {}
    opened = open_recordings(root, damaged)
    complaints = {str(path): error.message for path, error in damaged.items()}
    sources = []
    for recording in opened:
        try:
            _require_sound(recording, settings)
        except DamagedFile as error:
            complaints[str(recording)] = error.message
        else:
            sources.append(Source(_name(recording, root), recording))
    if complaints and not (skip_damaged and sources):
        raise _refusal(complaints, left=len(sources))
    return Sources(root, sources, complaints)


def _require_sound(recording: Recording, settings: CompressionSettings) -> None:
    """Raise DamagedFile where commands are not finite or do not fit the pictures, UsageError for sizes."""
    recording.motion  # noqa: B018  reading checks it
    choices = settings.choices()
    for camera in recording.cameras:
        formats_for(choices.settings(*choices.pixel_formats[:1]), camera.width, camera.height)
        recording.swapped(camera.name)  # notes it


def _refusal(complaints: dict[str, str], left: int) -> DamagedFile:
    shown = list(complaints.values())[:LISTED]
    more = f" and {len(complaints) - len(shown)} more" if len(complaints) > len(shown) else ""
    return DamagedFile(
        f"{'; '.join(shown)}{more}",
        hint=f"mend or remove them, or leave them out with --skip-damaged ({left} are sound)" if left else "",
        details={"damaged": complaints},
    )


def _name(recording: Recording, root: Path) -> str:
    if isinstance(recording, LeRobotRecording):
        return f"episode_{recording.index:06d}"
    if root.is_file() or recording.path == root:
        return recording.path.stem
    return recording.path.relative_to(root).with_suffix("").as_posix()


def _digest(path: Path) -> str:
    if path.is_file():
        return sha256_file(path)
    files = sorted(file for file in path.rglob("*") if file.is_file())
    told = "\n".join(f"{file.relative_to(path).as_posix()} {file.stat().st_size}" for file in files)
    return hashlib.sha256(told.encode()).hexdigest()
