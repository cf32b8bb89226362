"""A worker process: it answers each task, and ends with its parent."""

from __future__ import annotations

import logging
import multiprocessing
import os
import pickle
import signal
import threading
from collections.abc import Callable, Mapping
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from vcage.base.errors import UsageError

DONE, FAILED, SAID = range(3)
"""Kinds of messages: a result, an error, or a record of the log."""


def serve(connection: Connection, level: int, environment: Mapping[str, str]) -> None:
    """Take the work, then answer each task with (DONE, result) or (FAILED, error), until the process is ended.

    Args:
        connection: to the process that gives work and tasks.
        level: of what is logged.
        environment: of the process that gives the tasks.
    """
    _follow(environment)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's business
    threading.Thread(target=_end_with_parent, daemon=True).start()
    logging.basicConfig(level=level, format="%(message)s", handlers=[_ToParent(connection)], force=True)
    work: Callable[[Any], Any] | None = None
    while True:
        try:
            received = connection.recv_bytes()
        except EOFError:  # nothing more to do
            return
        try:
            if work is None:
                work = _loaded(received)
                continue
            answer = (DONE, work(_loaded(received)))
        except Exception as error:  # it is raised again where the result was waited for
            answer = (FAILED, error)
        try:
            connection.send(answer)
        except (TypeError, AttributeError, pickle.PicklingError) as error:
            connection.send((FAILED, TypeError(f"{answer[1]!r} cannot be sent between processes: {error}")))


def _loaded(pickled: bytes) -> Any:
    """Return what was sent to this process.

    Raises:
        UsageError: the script of the process that sent it defines it, which is not run here.
    """
    try:
        return pickle.loads(pickled)
    except AttributeError as error:
        if "__main__" not in str(error):
            raise
        raise UsageError(
            f"worker processes do not know what the script itself defines: {error}",
            hint="define it in a module of its own and import that, or take one worker",
        ) from error


def _follow(environment: Mapping[str, str]) -> None:
    """Take over another process's environment, except that what was imported here has set stays.

    A library may tell itself through the environment where its parts lie (SAPIEN does), whether or not the other
    process has imported it too.
    """
    block = Path("/proc/self/environ").read_bytes()  # as it was for this process, or the one that it is forked from
    entries = [os.fsdecode(entry).partition("=") for entry in block.split(b"\0") if entry]
    began = {name: value for name, _, value in entries}
    for name in began.keys() - environment.keys():
        os.environ.pop(name, None)
    os.environ.update({name: value for name, value in environment.items() if began.get(name) != value})


class _ToParent(logging.Handler):
    """Sends what is logged to the process that logs it for all."""

    def __init__(self, connection: Connection):
        super().__init__()
        self._connection = connection

    def emit(self, record: logging.LogRecord) -> None:
        self._connection.send((SAID, (record.name, record.levelno, self.format(record))))


def _end_with_parent() -> None:
    """A parent that is killed cannot end its workers."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
