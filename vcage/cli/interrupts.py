"""Ctrl-C and SIGTERM: noted even where a library swallows the exception, and survived by no tear-down."""

from __future__ import annotations

import contextlib
import gc
import logging
import os
import signal
import threading
from collections.abc import Iterator
from types import FrameType

from vcage.base.errors import VcageError


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
    """Note Ctrl-C, and what ``kill`` and schedulers send, besides raising :class:`KeyboardInterrupt`."""
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
    """Raise :class:`KeyboardInterrupt` if there was a Ctrl-C that a library has swallowed."""
    if _signalled.is_set():
        raise KeyboardInterrupt


def interruption(error: BaseException) -> Interrupted | None:
    """Return the error to report where a command was interrupted; None where it failed by itself.

    Args:
        error: what it ended with.
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
    gc.freeze()  # what is loaded need not be looked through once more: a fifth of a second
    return code
