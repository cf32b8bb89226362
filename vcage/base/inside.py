"""What stays inside a folder: relative paths that records hold, and folders in which nothing leads elsewhere.

A run folder may come from someone else. A path in one of its records is typed (:mod:`vcage.schema.base`) and is refused
where it could lead out of it; a folder or file of a run that is a link, or neither folder nor file, is refused before
anything of the run is read or written.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator
from pathlib import Path

from vcage.base.errors import InputFileError

LONGEST_PATH, LONGEST_NAME = 1024, 255
"""Bytes of a path in a record, and of each name in it: with more, systems refuse to look."""

DEEPEST = 64
"""Folders in one another that are looked into."""


def path_complaint(path: str, up: int = 0) -> str | None:
    """What is wrong with a path that should be relative and stay inside a folder; None where nothing is.

    Args:
        path: with forward slashes.
        up: how many folders it may go up at its beginning.
    """
    parts = [part for part in path.split("/") if part not in ("", ".")]
    while up > 0 and parts[:1] == [".."]:
        parts, up = parts[1:], up - 1
    if not parts or ".." in parts or path.startswith("/"):
        return f"expected a relative path that stays inside its folder, got {path[:80]!r}"
    if "\0" in path:
        return f"expected a path without NUL, got {path[:80]!r}"
    try:
        names = [os.fsencode(part) for part in parts]
    except UnicodeEncodeError:
        return f"expected a path that can be written as bytes, got {path[:80]!r}"
    if max(map(len, names)) > LONGEST_NAME or len(os.fsencode(path)) > LONGEST_PATH:
        return f"expected names of at most {LONGEST_NAME} bytes and {LONGEST_PATH} in all, got {len(path)}"
    return None


def name_complaint(name: str) -> str | None:
    """What is wrong with the bare name of a file; None where nothing is."""
    return f"expected the bare name of a file, got {name[:80]!r}" if "/" in name else path_complaint(name)


def require_no_links(root: Path, names: Collection[str]) -> None:
    """Nothing, if all that a folder holds under these names is folders and regular files.

    Args:
        root: the folder.
        names: of its entries that are looked at, up to the first dot: ``episodes`` is ``episodes.collecting`` too.

    Raises:
        InputFileError: something is a symbolic link, or a pipe, socket or device; names it.
    """
    found = [entry for entry in _entries(root) if entry.name.partition(".")[0] in names]
    for depth in range(DEEPEST + 1):
        folders = []
        for entry in found:
            if entry.is_symlink() or not (entry.is_file(follow_symlinks=False) or entry.is_dir(follow_symlinks=False)):
                raise _leads_out(entry)
            if entry.is_dir(follow_symlinks=False):
                folders.append(entry)
        if depth == DEEPEST and folders:
            raise InputFileError(f"{root} has folders in one another, more than {DEEPEST}", hint="see what is in it")
        found = [entry for folder in folders for entry in _entries(Path(folder.path))]


def _entries(folder: Path) -> Iterator[os.DirEntry[str]]:
    """What a folder holds; nothing where it is gone meanwhile."""
    try:
        with os.scandir(folder) as entries:
            yield from entries
    except (FileNotFoundError, NotADirectoryError):
        return


def _leads_out(entry: os.DirEntry[str]) -> InputFileError:
    if not entry.is_symlink():
        return InputFileError(f"{entry.path} is neither a file nor a folder", hint="remove it", details=_named(entry))
    return InputFileError(
        f"{entry.path} is a symbolic link: nothing is read or written through links in a run folder",
        hint="put what it names there in its place, or remove it",
        details=_named(entry),
    )


def _named(entry: os.DirEntry[str]) -> dict[str, str]:
    return {"path": entry.path}
