"""The streams of a command: text and JSON on stdout; complaints, and all that libraries print, on stderr."""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import sys
from collections.abc import Iterator
from contextvars import ContextVar
from typing import Any, TextIO


def complain(text: str) -> None:
    """Print one line on stderr, if that takes any."""
    try:
        sys.stderr.write(f"vcage: error: {text}\n")
        sys.stderr.flush()
    except OSError:
        _lead_nowhere(sys.stderr)


def print_record(record: dict[str, Any]) -> None:
    """Print a line of JSON to stdout, also inside :func:`stray_output_on_stderr`."""
    text = json.dumps(record, ensure_ascii=False)
    try:
        text.encode(_stdout().encoding or "utf-8")
    except UnicodeEncodeError:
        text = json.dumps(record)
    print_text(text)


def print_text(text: str) -> None:
    """Print to stdout, also inside :func:`stray_output_on_stderr`; a reader that has closed (``| head``) is no error.

    Raises:
        OSError: stdout takes nothing; it leads nowhere from now on.
    """
    try:
        _stdout().write(text + "\n")
        _stdout().flush()
    except OSError as error:
        _lead_nowhere(_stdout())
        if not isinstance(error, BrokenPipeError):
            raise


def _lead_nowhere(stream: TextIO) -> None:
    """Redirect a stream to nowhere: the interpreter flushes it once more at exit, which must not fail."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream.fileno())
    os.close(nowhere)


_real_stdout: ContextVar[TextIO | None] = ContextVar("real_stdout", default=None)
"""Where our lines go while stray output goes to stderr."""


def _stdout() -> TextIO:
    return _real_stdout.get() or sys.stdout


@contextlib.contextmanager
def stray_output_on_stderr() -> Iterator[None]:
    """Send prints of libraries to stderr, so that the last line of stdout is ours.

    Works on the file descriptor, since SAPIEN and others print from C++; those buffers are flushed at the end.
    """
    if not _stdout_is_the_process_own():
        with _printing_to(sys.stdout), contextlib.redirect_stdout(sys.stderr):
            yield
        return
    libc = ctypes.CDLL(None)
    encoding, errors = sys.stdout.encoding, sys.stdout.errors
    with os.fdopen(os.dup(1), "w", encoding=encoding, errors=errors) as real:
        os.dup2(2, 1)
        try:
            with (
                _printing_to(real if sys.stdout is sys.__stdout__ else sys.stdout),
                contextlib.redirect_stdout(sys.stderr),
            ):
                yield
        finally:
            libc.fflush(None)
            os.dup2(real.fileno(), 1)


@contextlib.contextmanager
def _printing_to(stream: TextIO) -> Iterator[None]:
    """Let our own lines go to a stream."""
    before = _real_stdout.set(stream)
    try:
        yield
    finally:
        _real_stdout.reset(before)


def _stdout_is_the_process_own() -> bool:
    """False where a test or a host program has put something else in place of stdout."""
    try:
        return sys.__stdout__ is not None and sys.__stdout__.fileno() == 1
    except ValueError:
        return False
