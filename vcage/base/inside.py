"""Keep to a folder: relative paths in records stay inside, and nothing in it leads elsewhere.

A run folder may come from someone else. A path in one of its records is typed (:mod:`vcage.schema.base`) and is refused
where it could lead out of it; a folder or file of a run that is a link, or neither folder nor file, is refused before
anything of the run is read or written.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

from vcage.base.errors import InputFileError


def path_complaint(path: str, up: int = 0) -> str | None:
    """Say why a path is not relative or leaves its folder; None for a good one.

    Args:
        path: with forward slashes.
        up: how many folders it may go up at its beginning.
    """
    parts = [part for part in path.split("/") if part not in ("", ".")]
    while up > 0 and parts[:1] == [".."]:
        parts, up = parts[1:], up - 1
    if not parts or ".." in parts or path.startswith("/"):
        return f"expected a relative path that stays inside its folder, got {path[:80]!r}"
    return _bytes_complaint(path, parts)


def _bytes_complaint(path: str, names: Sequence[str], max_path: int = 1024, max_name: int = 255) -> str | None:
    """Say why the file system cannot take a path of these names; None for one that it can.

    Args:
        max_path, max_name: bytes; with more in a name, systems refuse to look.
    """
    if "\0" in path:
        return f"expected a path without NUL, got {path[:80]!r}"
    try:
        longest, whole = max(len(os.fsencode(name)) for name in names), len(os.fsencode(path))
    except UnicodeEncodeError:
        return f"expected a path that can be written as bytes, got {path[:80]!r}"
    if longest > max_name or whole > max_path:
        most = f"names of at most {max_name} bytes and {max_path} in all"
        return f"expected {most}, got {whole}"
    return None


def name_complaint(name: str) -> str | None:
    """Say why this is not the bare name of a file; None for a good one."""
    return f"expected the bare name of a file, got {name[:80]!r}" if "/" in name else path_complaint(name)


def require_no_links(root: Path, names: Collection[str], max_depth: int = 64) -> None:
    """Require that a folder holds only folders and regular files under these names.

    Args:
        root: the folder.
        names: of its entries to check, up to the first dot: ``episodes`` is ``episodes.collecting`` too.
        max_depth: folders in one another.

    Raises:
        InputFileError: something is a symbolic link, or a pipe, socket or device; names it.
    """
    found = [entry for entry in _entries(root) if entry.name.partition(".")[0] in names]
    for depth in range(max_depth + 1):
        for entry in found:
            if not (entry.is_file(follow_symlinks=False) or entry.is_dir(follow_symlinks=False)):
                raise _leads_out(entry)
        folders = [entry for entry in found if entry.is_dir(follow_symlinks=False)]
        if depth == max_depth and folders:
            raise InputFileError(
                f"{folders[0].path} lies in more than {max_depth} folders of {root}", hint="see what is in it"
            )
        found = [entry for folder in folders for entry in _entries(Path(folder.path))]


def _entries(folder: Path) -> Iterator[os.DirEntry[str]]:
    """List a folder; nothing if it is gone meanwhile."""
    try:
        with os.scandir(folder) as entries:
            yield from entries
    except (FileNotFoundError, NotADirectoryError):
        return
    except PermissionError as error:
        raise InputFileError(f"{folder} cannot be read: {error.strerror}", hint="make it readable") from error


def _leads_out(entry: os.DirEntry[str]) -> InputFileError:
    named = {"path": entry.path}
    if not entry.is_symlink():
        return InputFileError(f"{entry.path} is neither a file nor a folder", hint="remove it", details=named)
    return InputFileError(
        f"{entry.path} is a symbolic link: nothing is read or written through links in a run folder",
        hint="replace it by the folder or file it names, or remove it",
        details=named,
    )
