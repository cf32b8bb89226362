"""Progress of a command for a person: log lines, and a bar if stderr is a terminal."""

from __future__ import annotations

import contextlib
import logging
import math
import sys
import time
from collections.abc import Iterator
from contextvars import ContextVar
from typing import Literal

from vcage.base.progress import Progress
from vcage.cli.streams import print_record

logger = logging.getLogger(__name__)

LEAST_S = 10.0
"""Seconds that must have passed, and be left, before the remaining time is shown."""


class _Stderr(logging.StreamHandler):
    """Writes to whatever ``sys.stderr`` is at the time, as a progress bar puts itself in its place."""

    def emit(self, record: logging.LogRecord) -> None:
        self.stream = sys.stderr
        super().emit(record)


class _Formatter(logging.Formatter):
    """Progress as plain lines, everything else with its level."""

    def format(self, record: logging.LogRecord) -> str:
        text = super().format(record)
        return text if record.levelno == logging.INFO else f"{record.levelname.lower()}: {text}"


_lines_of: ContextVar[Literal["text", "json"]] = ContextVar("lines_of", default="text")
"""Format of progress."""


def set_up(verbose: bool, lines_of: Literal["text", "json"]) -> None:
    """Log to stderr: our progress and everybody's warnings; with ``verbose`` our details and all progress."""
    _lines_of.set(lines_of)
    handler = _Stderr()
    handler.setFormatter(_Formatter("%(message)s"))
    logging.basicConfig(level=logging.INFO if verbose else logging.WARNING, handlers=[handler], force=True)
    logging.getLogger("vcage").setLevel(logging.DEBUG if verbose else logging.INFO)


@contextlib.contextmanager
def progress(title: str) -> Iterator[Progress]:
    """Show the steps of one job: a bar on a terminal, else a line each, in JSON on request."""
    if _lines_of.get() == "json":
        yield _records(title)
    elif sys.stderr.isatty():
        with _bar(title) as show:
            yield show
    else:
        yield _lines(title)


def _lines(title: str) -> Progress:
    begun, first, last = 0.0, 0, math.inf

    def show(step: str, done: int, total: int) -> None:
        nonlocal begun, first, last
        if done <= last:  # of the job, or of its next part; some may have been done by an earlier call
            begun, first = time.monotonic(), done
        last = done
        left = time_left(time.monotonic() - begun, done - first, total - first)
        logger.info("%s: [%d/%d] %s%s", title, done + 1, total, step, f" ({left} left)" if left else "")

    return show


def _records(title: str) -> Progress:
    def show(step: str, done: int, total: int) -> None:
        print_record({"stage": title, "step": step, "done": done, "total": total})

    return show


def time_left(elapsed: float, done: int, total: int) -> str:
    """Estimate the remaining time, in words; empty while too little is known, or it is short.

    Args:
        elapsed: seconds since the start.
        done: steps that are finished.
        total: steps in all.
    """
    if done == 0 or elapsed < LEAST_S:
        return ""
    seconds = elapsed / done * (total - done)
    if seconds < LEAST_S:
        return ""
    if seconds < 90:
        return f"about {round(seconds, -1):.0f} s"
    return f"about {seconds / 60:.0f} min" if seconds < 5400 else f"about {seconds / 3600:.1f} h"


@contextlib.contextmanager
def _bar(title: str) -> Iterator[Progress]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (
        TextColumn(title),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        TextColumn("{task.fields[step]}"),
    )
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=None, step="")
        yield lambda step, done, total: bar.update(task, completed=done, total=total, step=step)
