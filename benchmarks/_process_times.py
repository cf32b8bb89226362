"""Wall and CPU time of a command, with all processes that it starts."""

from __future__ import annotations

import ctypes
import os
import resource
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

_PR_SET_CHILD_SUBREAPER = 36
"""From <linux/prctl.h>: orphans below this process become its children, so that it can wait for them."""


@dataclass(frozen=True)
class Timed:
    """End of a command.

    Args:
        code: its exit code.
        stdout: what it printed.
        wall_s: seconds from its start to its end.
        cpu_s: CPU seconds of its process and all descendants, including those that outlive it.
    """

    code: int
    stdout: str
    wall_s: float
    cpu_s: float


def timed(command: Sequence[str]) -> Timed:
    """Run a command and wait for it and for every process below it.

    A fork server of Python has no parent when the process that started it ends. Its CPU time counts only if this
    process adopts it and waits for it.
    """
    ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    others, before, start = _children(), _cpu_of_children(), time.perf_counter()
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    wall = time.perf_counter() - start
    while orphans := _children() - others:
        for orphan in orphans:
            os.waitpid(orphan, 0)
    return Timed(done.returncode, done.stdout, wall, _cpu_of_children() - before)


def _children() -> set[int]:
    """The process ids of the children of this process."""
    lists = Path("/proc/self/task").glob("*/children")
    return {int(number) for path in lists for number in path.read_text().split()}


def _cpu_of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
