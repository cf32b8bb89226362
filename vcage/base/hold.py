"""Exclusive use of a folder: other processes are refused, or wait."""

from __future__ import annotations

import contextlib
import fcntl
import os
import platform
import shlex
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from filelock import FileLock, Timeout

from vcage.base.commands import CALLED
from vcage.base.errors import FolderInUse, OutputFolderError
from vcage.base.files import writing
from vcage.base.leftovers import sweep_scratch

IN_USE = "in-use"
"""File that names the process that works in its folder."""


@contextlib.contextmanager
def held(folder: Path) -> Iterator[None]:
    """Lock a folder for this process; the system releases the lock however the process ends.

    Raises:
        FolderInUse: another process holds it; says which.
        OutputFolderError: the file that says so is a link.
    """
    sweep_scratch()
    path = folder / IN_USE
    if path.is_symlink():
        raise OutputFolderError(f"{path} is a symbolic link, through which nothing is written", hint="remove it")
    with alone(path, of=folder):
        try:
            yield
        finally:
            path.unlink(missing_ok=True)


@contextlib.contextmanager
def alone(path: Path, of: Path | None = None) -> Iterator[None]:
    """Lock a file for this process, and write into it who holds it; the file stays.

    Args:
        path: of the file; the system releases the lock however the process ends.
        of: the folder that is held by it, for the error; the file itself by default.

    Raises:
        FolderInUse: another process holds it; says which.
        OutputFolderError, DiskFull: it cannot be written.
    """
    lock = FileLock(path)
    if (holder := _taken_by_another(lock, path)) is not None:
        hint = "wait for its end, or work in another folder"
        raise FolderInUse(f"{of or path} is in use by {holder}", hint=hint, details={"holder": holder})
    try:
        command = CALLED.get() or shlex.join(sys.argv)
        with writing(path):
            path.write_text(f"process {os.getpid()} on {platform.node()}: {command}\n", encoding="utf-8")
        yield
    finally:
        lock.release()


def holder_of(path: Path) -> str | None:
    """Return who holds a file by :func:`alone`, on whatever machine; None if nobody does, or it is not there.

    Whoever takes the file meanwhile is not refused.
    """
    with contextlib.suppress(FileNotFoundError), open(path, encoding="utf-8", errors="replace") as handle:
        try:
            fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return handle.readline().strip() or "another process"
    return None


def _taken_by_another(lock: FileLock, path: Path, within_s: float = 5.0) -> str | None:
    """Acquire the lock of a file, or return who holds it.

    :func:`holder_of` shares the lock for a moment, in which it cannot be acquired although nobody holds it.
    """
    end = time.monotonic() + within_s
    while True:
        try:
            with writing(path):
                lock.acquire(timeout=0)
            return None
        except Timeout:
            if (holder := holder_of(path)) is not None or time.monotonic() > end:
                return holder or "another process"
            time.sleep(0.001)


@contextlib.contextmanager
def one_at_a_time(folder: Path) -> Iterator[None]:
    """Wait while another process makes the same file or folder in such a block.

    Raises:
        OutputFolderError, DiskFull: nothing can be written beside it.
    """
    lock = FileLock(f"{folder}.lock")
    with writing(folder):
        lock.acquire()
    try:
        yield
    finally:
        lock.release()
