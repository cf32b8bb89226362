"""Walk folders of users: visible names in natural order, with links followed.

Names that begin with a dot belong to the system or to tools (``._episode_0.hdf5``, ``.DS_Store``, ``.cache``) and are
passed over. Links to folders are followed; a folder that lies in itself is entered once.
"""

from __future__ import annotations

import contextlib
import os
import re
import stat
from collections.abc import Iterator
from pathlib import Path

from vcage.base.errors import InputFileError, OutputFolderError, VcageError

NUMBER = re.compile(r"([0-9]+)")


NaturalKey = tuple[tuple[str | tuple[int, str], ...], str]


def natural_key(name: str) -> NaturalKey:
    """Sort key of a name by the numbers in it: ``episode_2`` comes before ``episode_10``."""
    parts = NUMBER.split(name)  # every second one is a number
    digits = [part.lstrip("0") for part in parts[1::2]]
    parts[1::2] = [(len(number), number) for number in digits]
    return tuple(parts), name


def natural_path(path: Path) -> tuple[NaturalKey, ...]:
    """Sort key of a path, folder by folder; see :func:`natural_key`."""
    return tuple(natural_key(part) for part in path.parts)


def is_hidden(name: str) -> bool:
    """Check for a name of the system or a tool, not a user's."""
    return name.startswith(".")


@contextlib.contextmanager
def listing(folder: Path) -> Iterator[None]:
    """Name the folder in errors of the system while it is listed.

    Raises:
        InputFileError: the folder cannot be read.
    """
    try:
        yield
    except OSError as error:
        raise InputFileError(f"{folder} cannot be read: {error.strerror}", hint="make it readable") from error


def entries(folder: Path) -> list[Path]:
    """List a folder in natural order, without hidden names.

    Raises:
        InputFileError: the folder cannot be read.
    """
    with listing(folder):
        found = list(folder.iterdir())
    return sorted((path for path in found if not is_hidden(path.name)), key=lambda path: natural_key(path.name))


def is_empty_folder(folder: Path) -> bool:
    """Check for a folder that holds hidden names at most."""
    return folder.is_dir() and not entries(folder)


def files_below(folder: Path, *, repeated: bool = False, max_folders: int = 100_000) -> list[Path]:
    """All files below a folder in natural order, links to folders followed, without hidden names.

    A link with a missing target counts as a file, so that the reader can name it.

    Args:
        folder: where to look.
        repeated: list a folder under each of its names. By default its files are listed once, under the real name where
            that lies below ``folder`` too.
        max_folders: links can make few folders look like endlessly many.

    Raises:
        InputFileError: a folder cannot be read, or there are too many.
    """
    return sorted(_walk(folder, repeated, max_folders), key=natural_path)


def _walk(top: Path, repeated: bool, max_folders: int) -> Iterator[Path]:
    seen: set[str] = set()
    entered = 0
    folders, links = [(top, frozenset[str]())], list[tuple[Path, frozenset[str]]]()
    while folders or links:
        folder, around = folders.pop() if folders else links.pop(0)
        real = os.path.realpath(folder)
        if real in (around if repeated else seen):
            continue
        seen.add(real)
        entered += 1
        if entered > max_folders:
            raise InputFileError(
                f"{top} holds more than {max_folders:,} folders, links followed", hint="remove links to folders"
            )
        for path in entries(folder):
            if not path.is_dir():
                yield path
            elif path.is_symlink():
                links.append((path, around | {real}))
            else:
                folders.append((path, around | {real}))


def real_path(path: str | Path) -> Path:
    """A path from the root, with ``~`` expanded and without links.

    Raises:
        OutputFolderError: links lead in a circle, or nobody has the home that it names.
    """
    try:
        return Path(path).expanduser().resolve()
    except RuntimeError as error:
        raise OutputFolderError(f"{path} is no folder: {error}", hint="give another path") from error


def size_of(folder: Path) -> tuple[int, int]:
    """Return the bytes of all files below a folder, and the number of files and folders there.

    A file with several names counts once, as it does on the disk; links are not followed.
    """
    found = {status.st_ino: status for status in (path.lstat() for path in folder.rglob("*"))}
    return sum(one.st_size for one in found.values() if stat.S_ISREG(one.st_mode)), len(found)


def require_utf8(path: Path, refused: type[VcageError] = InputFileError) -> None:
    """Nothing, if a whole path can be written into records, which are UTF-8.

    Args:
        path: of a file or folder.
        refused: error that is raised if it cannot; it shows the path with escapes.
    """
    try:
        str(path.absolute()).encode()
    except UnicodeEncodeError as error:
        shown = os.fsencode(path.absolute()).decode(errors="backslashreplace")
        raise refused(f"the path {shown} is not UTF-8, as records are", hint="rename the file or folder") from error
