"""Wall and CPU time of a command, with all processes that it starts."""

from __future__ import annotations

import ctypes
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

_PR_SET_CHILD_SUBREAPER = 36
"""From <linux/prctl.h>: orphans below this process become its children, so that it can wait for them."""


@dataclass(frozen=True)
class Mark:
    """The moment of a line on a command's stderr.

    Args:
        line: what it says.
        wall_s: seconds since the command's start.
        cpu_s: CPU seconds of its process and all descendants so far.
    """

    line: str
    wall_s: float
    cpu_s: float


@dataclass(frozen=True)
class Timed:
    """End of a command.

    Args:
        code: its exit code.
        stdout: what it printed.
        wall_s: seconds from its start to its end.
        cpu_s: CPU seconds of its process and all descendants, including those that outlive it.
        marks: of all lines on stderr.
    """

    code: int
    stdout: str
    wall_s: float
    cpu_s: float
    marks: list[Mark]


def timed(command: Sequence[str]) -> Timed:
    """Run a command and wait for it and for every process below it.

    A fork server of Python has no parent when the process that started it ends. Its CPU time counts only if this
    process adopts it and waits for it.
    """
    ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    others, before, start = _children(), _cpu_of_children(), time.perf_counter()
    marks: list[Mark] = []
    with (
        tempfile.TemporaryFile("w+") as stdout,
        subprocess.Popen(command, stdout=stdout, stderr=subprocess.PIPE, text=True) as process,
    ):
        for line in process.stderr or ():
            sys.stderr.write(line)
            marks.append(Mark(line.rstrip(), time.perf_counter() - start, _cpu_of_tree(process.pid)))
        process.wait()
        wall = time.perf_counter() - start
        stdout.seek(0)
        printed = stdout.read()
    while orphans := _children() - others:
        for orphan in orphans:
            os.waitpid(orphan, 0)
    return Timed(process.returncode, printed, wall, _cpu_of_children() - before, marks)


def _cpu_of_tree(process: int) -> float:
    """Return the CPU seconds of a process and all below it."""
    ticks, waiting = 0, [process]
    while waiting:
        folder = Path(f"/proc/{waiting.pop()}")
        with suppress(FileNotFoundError, ProcessLookupError):  # it ends meanwhile, and its parent has its seconds
            below = [int(child) for path in folder.glob("task/*/children") for child in path.read_text().split()]
            ticks += sum(map(int, (folder / "stat").read_text().rpartition(")")[2].split()[11:15]))
            waiting += below
    return ticks / os.sysconf("SC_CLK_TCK")


def _children() -> set[int]:
    """The process ids of the children of this process."""
    lists = Path("/proc/self/task").glob("*/children")
    return {int(number) for path in lists for number in path.read_text().split()}


def _cpu_of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
