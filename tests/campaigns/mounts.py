"""A file system of its own for a part of a test, seen by its thread and by processes that it starts."""

from __future__ import annotations

import ctypes
import os
import subprocess
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

CLONE_NEWNS = 0x00020000
"""From <linux/sched.h>: mounts of its own."""


def _may_mount() -> bool:
    if os.geteuid() != 0:
        return False
    command = ["unshare", "-m", "mount", "-t", "tmpfs", "none", "/tmp"]
    return subprocess.run(command, stderr=subprocess.DEVNULL, check=False).returncode == 0


needs_mounts = pytest.mark.skipif(not _may_mount(), reason="only root may mount a file system for a test")


def elsewhere(do: Callable[[], object], mount_over: Path, size: str = "50%") -> None:
    """Do something in a thread for which, and for whose processes, an empty file system lies in some place.

    Args:
        do: what to do.
        mount_over: the place, a folder.
        size: of the file system, as ``mount`` takes it.
    """
    faults: list[BaseException] = []

    def work() -> None:
        try:
            assert ctypes.CDLL(None, use_errno=True).unshare(CLONE_NEWNS) == 0, os.strerror(ctypes.get_errno())
            subprocess.run(["mount", "--make-rprivate", "/"], check=True)
            subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "none", mount_over], check=True)
            do()
        except BaseException as error:
            faults.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    if faults:
        raise faults[0]


def grow(place: Path, size: str) -> None:
    """Give the file system of a place another size."""
    subprocess.run(["mount", "-o", f"remount,size={size}", place], check=True)
