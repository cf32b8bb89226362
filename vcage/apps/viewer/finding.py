"""Find the episodes at a path: a file of ours, those of a run, or other projects' recordings."""

from __future__ import annotations

from pathlib import Path

from vcage.base.errors import MissingStage, UnknownName
from vcage.base.files import RunFolder
from vcage.datasets.hdf5 import SCHEMA
from vcage.datasets.hdf5_files import damage, open_hdf5_file
from vcage.datasets.picture_links import read_link
from vcage.datasets.recordings.opening import open_recordings
from vcage.datasets.recordings.recording import Recording
from vcage.schema.episodes import Episodes


def find_episodes(path: Path) -> dict[int, Path | Recording]:
    """Return the episodes at a path by number: our own files as paths, other recordings opened.

    A run folder offers all its episodes that have a file, the rejected too, by their numbers in the run. An episode of
    ours whose pictures were moved to videos counts as a recording.

    Raises:
        InputFileError: there is nothing at the path, or nothing that is known.
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
