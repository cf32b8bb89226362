"""The process of a command: its streams, folder and open files, and its end.

Ctrl-C and SIGTERM are noted even where a library swallows the exception, and survived by no tear-down.
"""

from __future__ import annotations

import contextlib
import gc
import logging
import os
import resource
import signal
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from vcage.base import own_process
from vcage.base.errors import ConfigurationError, UsageError, VcageError
from vcage.base.memory import reuse_freed_memory

STREAMS = ("stdin", "stdout", "stderr")


@dataclass(frozen=True)
class FileLimits:
    """Limits of open files; a run with two workers has up to a hundred.

    Args:
        required: with fewer, no command begins.
        wanted: the limit is raised to this where the system allows it.
    """

    required: int = 256
    wanted: int = 4096


LIMITS = FileLimits()


def prepare() -> None:
    """Prepare this process for a command; call it first."""
    _open_closed_streams()
    own_process.runs_a_command = True
    reuse_freed_memory()
    with contextlib.suppress(OSError, ValueError):
        most = resource.getrlimit(resource.RLIMIT_NOFILE)
        wanted = LIMITS.wanted if most[1] == resource.RLIM_INFINITY else min(LIMITS.wanted, most[1])
        if most[0] != resource.RLIM_INFINITY and most[0] < wanted:
            resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, most[1]))


def require_fit() -> None:
    """Check that a command can work in this process.

    Raises:
        UsageError: the current folder was removed.
        ConfigurationError: too few files may be open at a time.
    """
    if folder_is_gone():
        raise removed_folder()
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    if most != resource.RLIM_INFINITY and most < LIMITS.required:
        raise ConfigurationError(
            f"only {most} files may be open at a time; at least {LIMITS.required} are needed",
            hint=f"raise the limit, in a new shell if need be: ulimit -n {LIMITS.wanted}",
        )


def folder_is_gone() -> bool:
    """True if the current folder was removed."""
    try:
        Path.cwd()
    except FileNotFoundError:
        return True
    return False


def removed_folder() -> UsageError:
    """Return the error for :func:`folder_is_gone`."""
    return UsageError("the current folder was removed", hint="go to one that exists: cd")


def _open_closed_streams() -> None:
    """Let stdin, stdout and stderr lead nowhere where the caller closed them, or the next file that is opened would
    take their place and receive the prints of libraries. Characters of a name that stdout cannot show are escaped."""
    for number, name in enumerate(STREAMS):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free
            setattr(sys, name, os.fdopen(number, "r" if number == 0 else "w", encoding="utf-8", closefd=False))
            setattr(sys, f"__{name}__", getattr(sys, name))
            if name == "stdout":
                with contextlib.suppress(OSError):
                    os.write(2, b"vcage: stdout is closed, so the result is not printed\n")
    with contextlib.suppress(AttributeError):  # something else stands in its place
        sys.stdout.reconfigure(errors="backslashreplace")  # pyrefly: ignore


# --- interruptions ----------------------------------------------------------------------------------------


class Interrupted(VcageError):
    """Ctrl-C, or SIGTERM, ended the command."""

    code = "interrupted"
    exit_code = 130  # as shells have it: 128 + SIGINT
    retryable = True


_signalled = threading.Event()
"""Set by Ctrl-C and SIGTERM. Libraries in C that are being imported swallow the exception, or make another of it."""

_stopped: list[BaseException] = []
"""Kept until the process ends: to let go of one lets go of what it stopped, which crashes (:func:`end_process`)."""


@contextlib.contextmanager
def noting_interrupts() -> Iterator[None]:
    """Note Ctrl-C, and signals of ``kill`` and schedulers, besides raising :class:`KeyboardInterrupt`."""
    _signalled.clear()

    def note(number: int, frame: FrameType | None) -> None:
        _signalled.set()
        signal.default_int_handler(number, frame)

    usual = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}
    if threading.current_thread() is not threading.main_thread():
        usual = {}
    before = {number: handler for number, handler in usual.items() if signal.getsignal(number) is handler}
    for number in before:
        signal.signal(number, note)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def stop_if_interrupted() -> None:
    """Raise :class:`KeyboardInterrupt` after a Ctrl-C swallowed by a library."""
    if _signalled.is_set():
        raise KeyboardInterrupt


def interruption(error: BaseException) -> Interrupted | None:
    """Return the error to report where a command was interrupted; None where it failed by itself.

    Args:
        error: the one it ended with.
    """
    if not isinstance(error, KeyboardInterrupt) and not _signalled.is_set():
        return None
    _stopped.append(error)
    return Interrupted("interrupted", hint="run the same command again to go on")


def end_process(code: int) -> int:
    """Return the exit code for ``sys.exit``; after an interruption end the process at once.

    The simulator's tear-down crashes when it was stopped in the middle of its work.
    """
    if code == Interrupted.exit_code:
        from vcage.base.worker_process import remove_server_files

        remove_server_files()
        logging.shutdown()
        os._exit(code)
    gc.freeze()  # skipping loaded objects saves the collector a fifth of a second
    return code
