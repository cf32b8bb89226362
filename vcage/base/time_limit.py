"""A time limit for a block of code."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


class TimeLimitReached(BaseException):
    """Raised inside :func:`time_limit`; no handler of errors stops it on its way."""


class _Held:
    """Number of open :func:`undisturbed` blocks, and whether an alarm came meanwhile."""

    depth = 0
    rung = False


@contextmanager
def time_limit(seconds: float, repeat_s: float = 1.0) -> Iterator[None]:
    """Raise :class:`TimeLimitReached` in a block that takes longer; only in the main thread of a process.

    Code outside Python is not interrupted, nor is a block in :func:`undisturbed`: the outer block ends after it.
    A binding that was just converting its arguments takes the interruption for a wrong type: it may raise another
    error, which counts as the time being up, or go on, so the alarm is repeated.

    Args:
        seconds: for the block.
        repeat_s: interval of further alarms; longer than cleaning up takes, which an alarm must not interrupt.
    """
    over = False

    def ring(_number: int, _frame: object) -> None:
        nonlocal over
        over = True
        if not _Held.depth:
            raise TimeLimitReached
        _Held.rung = True

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds, repeat_s)
    try:
        yield
    except Exception as error:
        if over:
            raise TimeLimitReached from error
        raise
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
        _Held.rung = False


@contextmanager
def undisturbed() -> Iterator[None]:
    """Delay :class:`TimeLimitReached` to the end of a block or decorated function that must not stop halfway.

    Drawing is one: destroying a world that the driver still draws kills the process.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    _Held.depth += 1
    try:
        yield
    finally:
        _Held.depth -= 1
    if _Held.rung and not _Held.depth:
        raise TimeLimitReached
