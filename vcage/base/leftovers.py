"""Partial work and temporary folders: their names, and their removal once the process that made them was killed.

A temporary folder is locked by its process until that ends, in any way: one that can be locked was left behind.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import re
import shutil
import tempfile
import time
from collections.abc import Collection, Iterator
from pathlib import Path

PARTIAL = ".partial-"
"""Marks partial work; it may be deleted when nothing runs."""

REPLACED = ".replaced-"
"""Marks a finished folder under replacement; it is restored if the replacement failed."""

SCRATCH = ".vcage-scratch-"
"""Begins the name of a temporary folder of ours."""

OURS = "vcage"
"""File that marks a temporary folder of Python's as one that this project uses."""

OF_PYTHON = "pymp-"

PARTIAL_NAME = re.compile(rf"(?P<of>.+?){re.escape(PARTIAL)}\d+(\..*)?", re.DOTALL)
REPLACED_NAME = re.compile(rf"(?P<of>.+){re.escape(REPLACED)}\d+", re.DOTALL)


@contextlib.contextmanager
def scratch_folder() -> Iterator[Path]:
    """A temporary folder for this process, removed at the end, or by the next process if this one is killed."""
    sweep_scratch()
    folder, lock = _new_scratch()
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        os.close(lock)


def mark_scratch(folder: Path) -> None:
    """Let a temporary folder that Python keeps until this process ends be removed by the next one if it is killed."""
    if not (folder / OURS).exists():
        _lock(folder)  # until the process ends
        (folder / OURS).touch()


def sweep_scratch() -> None:
    """Remove the temporary folders that killed processes of this user left."""
    with contextlib.suppress(OSError), os.scandir(tempfile.gettempdir()) as entries:
        for entry in entries:
            if not entry.name.startswith((SCRATCH, OF_PYTHON)) or not entry.is_dir(follow_symlinks=False):
                continue
            folder = Path(entry.path)
            marked = entry.name.startswith(SCRATCH) or (folder / OURS).is_file()
            if marked and entry.stat(follow_symlinks=False).st_uid == os.getuid():
                _remove_unless_locked(folder)


def sweep_folder(folder: Path, names: Collection[str]) -> None:
    """Remove partial work of killed processes in a folder held by this process, and put back the files they replaced.

    Args:
        folder: held by this process.
        names: of our files, without their suffix, and of our folders in ``folder``, with all their contents.
    """
    with os.scandir(folder) as entries:
        there = sorted(Path(entry.path) for entry in entries)
    for path in there:
        name = PARTIAL_NAME.fullmatch(path.name) or REPLACED_NAME.fullmatch(path.name)
        if name and name["of"] in names:
            _repair(path)
        elif path.name in names and path.is_dir() and not path.is_symlink():
            for part in sorted(path.rglob(f"*{PARTIAL}*")):
                _repair(part)


def sweep_cache(cache: Path, age_s: float = 24 * 3600.0) -> None:
    """Remove what processes left in the cache that were killed while they made something for it.

    Args:
        cache: its folder.
        age_s: of partial work that is taken for left over. Other machines and containers may share the cache, and a
            slow download does not touch the folder that it will fill.
    """
    with contextlib.suppress(OSError):
        for path in cache.glob(f"*/*{PARTIAL}*"):
            if time.time() - path.lstat().st_mtime > age_s:
                _repair(path)


def _repair(path: Path) -> None:
    """Remove partial work of a process that has ended; put back, or remove, the file to be replaced."""
    if replaced := REPLACED_NAME.fullmatch(path.name):
        recover(path.with_name(replaced["of"]))
    elif PARTIAL_NAME.fullmatch(path.name):
        _remove_partial(path)


def _new_scratch() -> tuple[Path, int]:
    """A locked folder, and the lock."""
    while True:
        folder = Path(tempfile.mkdtemp(prefix=SCRATCH))
        with contextlib.suppress(BlockingIOError, FileNotFoundError):  # swept before it was locked
            lock = _lock(folder)
            if folder.exists():
                return folder, lock
            os.close(lock)


def _lock(folder: Path) -> int:
    """Lock a folder until the returned file is closed; on a file system without locks, nobody can.

    Raises:
        BlockingIOError: another process has locked it.
    """
    file = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(file)
        raise
    except OSError:
        pass
    return file


def _remove_unless_locked(folder: Path) -> None:
    with contextlib.suppress(OSError):
        file = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            shutil.rmtree(folder, ignore_errors=True)
        finally:
            os.close(file)


def is_written(part: Path) -> bool:
    """Check that the process with the number in the name still runs on this machine, and is not this one."""
    number = part.name.partition(PARTIAL)[2].partition(".")[0]
    if not number.isdecimal() or int(number) == os.getpid():
        return False
    try:
        os.kill(int(number), 0)
    except ProcessLookupError:
        return False
    except PermissionError:  # another user's
        return True
    return not _has_ended(int(number))


def _has_ended(number: int) -> bool:
    """True for a process that has ended and still has a number, as its parent never asked how it ended."""
    try:
        status = Path(f"/proc/{number}/stat").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return False
    return status.rpartition(")")[2].split()[:1] == ["Z"]


def recover(path: Path) -> None:
    """Repair leftovers of a killed ``atomic_folder`` or ``atomic_path`` beside ``path``.

    A folder moved away for a replacement that never came is moved back; partial work is deleted, except that
    of a living process.
    """
    path = Path(path)
    if not path.parent.is_dir():
        return
    for old in sorted(path.parent.glob(f"{path.name}{REPLACED}*")):
        if path.exists():
            shutil.rmtree(old, ignore_errors=True)
        else:
            os.replace(old, path)
    leftovers = set(path.parent.glob(f"{path.name}{PARTIAL}*")) | set(
        path.parent.glob(f"{path.stem}{PARTIAL}*{path.suffix}")
    )
    for part in leftovers:
        _remove_partial(part)


def _remove_partial(part: Path) -> None:
    """Remove partial work, unless its process is still there."""
    if is_written(part):
        return
    if part.is_dir() and not part.is_symlink():
        shutil.rmtree(part, ignore_errors=True)
    else:
        part.unlink(missing_ok=True)
