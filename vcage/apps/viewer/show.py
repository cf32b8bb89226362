"""Open an episode in the viewer, or write it into a file for it."""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from vcage.apps.viewer.blueprint import Contents, blueprint
from vcage.apps.viewer.episode import PictureSource, log_episode, log_recording
from vcage.apps.viewer.rerun_log import RerunLog, rr
from vcage.base.commands import pip_command
from vcage.base.errors import ConfigurationError, MissingStage, UnknownName, UsageError
from vcage.base.files import RunFolder, write_bytes
from vcage.base.progress import Progress, silent
from vcage.datasets.hdf5 import SCHEMA
from vcage.datasets.hdf5_files import damage, open_hdf5_file
from vcage.datasets.picture_links import read_link
from vcage.datasets.recordings.opening import open_recordings
from vcage.datasets.recordings.recording import Recording
from vcage.schema.episodes import Episodes

APPLICATION = "vcage"
"""Under this name the viewer remembers what its user changed in the layout."""

SUFFIX = ".rrd"

FILE = f"FILE{SUFFIX}"
"""How hints call it."""

PORT = 9876
"""Where viewers listen, by Rerun's default."""


@dataclass(frozen=True)
class Shown:
    """An episode that was shown.

    Args:
        number: of the episode, among those at its path.
        of: how many there are.
        contents: of the Rerun recording.
    """

    number: int
    of: int
    contents: Contents


def view(
    path: Path,
    *,
    number: int | None = None,
    save: Path | None = None,
    footage: PictureSource = "stored",
    fps: float | None = None,
    progress: Progress = silent,
) -> Shown:
    """Show an episode of ours or a recording of others.

    Args:
        path: see :func:`vcage.apps.viewer.show.find_episodes`.
        number: which of them, where a path holds several; the first by default.
        save: the ``.rrd`` file to write; without, the viewer is opened.
        footage: which pictures; recordings of others have no compressed ones.
        fps: frames per second of a recording that does not say.

    Raises:
        InputFileError: the path holds nothing known, or its content is damaged.
        MissingStage, UnknownName: there is no episode, or none of that number.
        UsageError: ``save`` has another suffix; ``footage`` cannot be had.
        ConfigurationError: there is no screen for the viewer.
        OutputFolderError, DiskFull: the file cannot be written.
    """
    path = Path(path)
    if save is not None and save.suffix != SUFFIX:
        raise UsageError(f"{save} is not a Rerun recording (*.rrd)", hint=f"end it in {SUFFIX}")
    if save is None:
        _require_viewer(footage)
    found = find_episodes(path)
    number = choose(found, number, path)
    one = found[number]
    if isinstance(one, Recording) and footage == "compressed":
        raise UsageError(
            f"{path} is not an episode of a run, and has no compressed videos", hint="leave out --pictures"
        )

    def write(stream: rr.RecordingStream) -> Contents:
        stream.send_recording_name(f"{path.name} {number}" if len(found) > 1 else path.name)
        log = RerunLog(stream)
        if isinstance(one, Recording):
            contents = log_recording(log, one, fps, footage != "none", progress)
        else:
            contents = log_episode(log, one, footage, progress)
        stream.send_blueprint(blueprint(contents))
        return contents

    return Shown(number, len(found), _to_viewer(write) if save is None else _to_file(write, save))


@contextmanager
def _stream() -> Iterator[rr.RecordingStream]:
    """A stream that is closed also when writing fails: one left open stops the next one's making for ever (0.23)."""
    stream = rr.RecordingStream(APPLICATION)
    try:
        yield stream
    finally:
        stream.disconnect()  # sends buffered data


def _to_file(write: Callable[[rr.RecordingStream], Contents], save: Path) -> Contents:
    RunFolder(save.parent).make()
    with _stream() as stream:
        sink = stream.binary_stream()  # Rerun's own writer of files only logs that a disk is full
        try:
            contents = write(stream)
        finally:
            data = sink.read() or b""  # the viewer warns of dropped data
    write_bytes(save, data)
    return contents


def _to_viewer(write: Callable[[rr.RecordingStream], Contents]) -> Contents:
    with _stream() as stream:
        _spawn(stream)
        contents = write(stream)
    _require_still_open()
    return contents


def _require_still_open() -> None:
    """Rerun does not say when the viewer ended while it was being told."""
    try:
        socket.create_connection(("127.0.0.1", PORT), timeout=5).close()
    except OSError as error:
        raise ConfigurationError(
            f"the viewer ended before it had all: {error}", hint=f"stderr says why; or write a file with --save {FILE}"
        ) from error


def _spawn(stream: rr.RecordingStream) -> None:
    """Open the viewer, or connect to an open one; it is a program beside this interpreter."""
    path = os.environ.get("PATH", "")
    os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), path])
    try:
        stream.spawn(port=PORT)
    except RuntimeError as error:
        raise ConfigurationError(
            f"the viewer does not start: {error}",
            hint=f"--save {FILE}, or install it again",
            command=pip_command("vcage[view]"),
        ) from error
    finally:
        os.environ["PATH"] = path


def _require_viewer(footage: PictureSource) -> None:
    """Refuse an episode that the viewer here cannot show.

    That of rerun-sdk 0.23 decodes no HEVC; those from 0.25 on do by ffmpeg: https://github.com/rerun-io/rerun/pull/10994.
    """
    if footage == "compressed":
        raise UsageError(
            "the viewer of this version of Rerun cannot decode the compressed videos",
            hint=f"--save {FILE} for a viewer from 0.25 on, on a machine with ffmpeg; or leave out --pictures",
        )
    if sys.platform == "linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise ConfigurationError(
            "the viewer needs a screen",
            hint=f"write a file with --save {FILE} and open it where there is one: rerun {FILE}",
        )


def find_episodes(path: Path) -> dict[int, Path | Recording]:
    """Return the episodes at a path by number: our own files as paths, other recordings opened.

    A run folder offers all its episodes that have a file, the rejected too, by their numbers in the run. An episode of
    ours whose pictures were moved to videos counts as a recording.

    Raises:
        InputFileError: the path holds nothing, or nothing known.
        DamagedFile, SchemaMismatch: a file is damaged, or in no layout that is known; names it.
    """
    path = Path(path)
    if path.is_file():
        return {0: path} if _is_whole(path) else dict(enumerate(open_recordings(path)))
    run = RunFolder(path.parent if (path / "episodes.json").is_file() else path)
    if run.episodes.is_file():
        return {e.index: run.file(e.file) for e in Episodes.read(run.episodes).episodes if e.file is not None}
    found = open_recordings(path)
    return dict(enumerate(one.path if one.path.is_file() and _is_whole(one.path) else one for one in found))


def choose(found: dict[int, Path | Recording], number: int | None, path: Path) -> int:
    """Return ``number`` if that episode exists, by default the first.

    Args:
        found: as :func:`find_episodes` found them.
        number: of one of them; None for the first.
        path: where they were found, for the message.

    Raises:
        MissingStage: nothing was found at ``path``.
        UnknownName: there is none of that number.
    """
    if not found:
        raise MissingStage(f"{path} holds no episode with a file", hint="collect more, with a larger --episodes")
    if number is None:
        return min(found)
    if number not in found:
        raise UnknownName("episode", str(number), map(str, found))
    return number


def _is_whole(path: Path) -> bool:
    """True for a file that is an episode of ours, of any version, with its pictures inside."""
    with damage(path), open_hdf5_file(path) as file:
        ours = str(file.attrs.get("schema", "")).startswith(SCHEMA.partition("/")[0])
        return ours and all(read_link(pictures) is None for pictures in file.get("observations/images", {}).values())
