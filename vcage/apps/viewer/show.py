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
from vcage.apps.viewer.finding import choose, find_episodes
from vcage.apps.viewer.rerun_log import RerunLog, rr
from vcage.base.commands import pip_command
from vcage.base.errors import ConfigurationError, UsageError
from vcage.base.files import RunFolder, write_bytes
from vcage.base.progress import Progress, silent
from vcage.datasets.recordings.recording import Recording

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
        number: of the episode, among those there are at its path.
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
        path: see :func:`vcage.apps.viewer.finding.find_episodes`.
        number: which of them, where a path holds several; the first by default.
        save: the ``.rrd`` file to write; without, the viewer is opened.
        footage: which pictures; recordings of others have no compressed ones.
        fps: frames per second of a recording that does not say.

    Raises:
        InputFileError: the path holds nothing that is known, or what it holds is damaged.
        MissingStage, UnknownName: there is no episode, or none of that number.
        UsageError: ``save`` has another suffix; ``footage`` cannot be had.
        ConfigurationError: there is no screen for the viewer.
        OutputFolderError, DiskFull: the file cannot be written.
    """
    path = Path(path)
    if save is not None and save.suffix != SUFFIX:
        raise UsageError(f"{save} is no name of a Rerun recording", hint=f"end it in {SUFFIX}")
    if save is None:
        _require_viewer(footage)
    found = find_episodes(path)
    number = choose(found, number, path)
    contents_of = _writer(found[number], path, footage, fps, progress)

    def write(stream: rr.RecordingStream) -> Contents:
        stream.send_recording_name(f"{path.name} {number}" if len(found) > 1 else path.name)
        contents = contents_of(RerunLog(stream))
        stream.send_blueprint(blueprint(contents))
        return contents

    return Shown(number, len(found), _to_viewer(write) if save is None else _to_file(write, save))


def _writer(
    one: Path | Recording, path: Path, footage: PictureSource, fps: float | None, progress: Progress
) -> Callable[[RerunLog], Contents]:
    """Return the function that logs an episode of ours, or another recording found at ``path``."""
    if not isinstance(one, Recording):
        return lambda log: log_episode(log, one, footage, progress)
    if footage == "compressed":
        raise UsageError(f"{path} is no episode of a run, and has no compressed videos", hint="leave out --pictures")
    return lambda log: log_recording(log, one, fps, footage != "none", progress)


@contextmanager
def _stream() -> Iterator[rr.RecordingStream]:
    """A stream that is closed also when writing fails: one left open stops the next one's making for ever (0.23)."""
    stream = rr.RecordingStream(APPLICATION)
    try:
        yield stream
    finally:
        stream.disconnect()  # sends what is still in memory


def _to_file(write: Callable[[rr.RecordingStream], Contents], save: Path) -> Contents:
    RunFolder(save.parent).make()
    with _stream() as stream:
        sink = stream.binary_stream()  # Rerun's own writer of files only logs that a disk is full
        try:
            contents = write(stream)
        finally:
            data = sink.read() or b""  # what is dropped unread is warned of
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
    """Open the viewer, or connect to one that is open; it is a program beside this interpreter."""
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
    """Refuse what the viewer here cannot show.

    That of rerun-sdk 0.23 decodes no HEVC; those from 0.25 on do by ffmpeg: https://github.com/rerun-io/rerun/pull/10994.
    """
    if footage == "compressed":
        raise UsageError(
            "the viewer of this version of Rerun cannot decode the compressed videos",
            hint=f"--save {FILE} for a viewer from 0.25 on, on a machine with ffmpeg; or leave out --pictures",
        )
    if sys.platform == "linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise ConfigurationError(
            "there is no screen to open the viewer on",
            hint=f"write a file with --save {FILE} and open it where there is one: rerun {FILE}",
        )
