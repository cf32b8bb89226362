"""Worker processes: forked from one with the needed imports, and without this program's script; they end with it."""

from __future__ import annotations

import logging
import multiprocessing
import os
import pickle
import shutil
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from multiprocessing import forkserver, resource_tracker, spawn, util
from multiprocessing.connection import Connection
from multiprocessing.context import ForkServerContext, SpawnContext
from multiprocessing.process import BaseProcess
from multiprocessing.util import get_temp_dir
from pathlib import Path
from typing import Any

from vcage.base import own_process
from vcage.base.errors import UsageError
from vcage.base.leftovers import mark_scratch, sweep_scratch
from vcage.base.memory import reuse_freed_memory

DONE, FAILED, SAID = range(3)
"""Kinds of messages: a result, an error, or a record of the log."""


def serve(connection: Connection, level: int, environment: Mapping[str, str]) -> None:
    """Take the work, then answer each task with (DONE, result) or (FAILED, error), until the process is ended.

    Args:
        connection: to the process that gives work and tasks.
        level: of the log records.
        environment: of the process that gives the tasks.
    """
    _follow(environment)
    reuse_freed_memory()
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
    """Return the object sent to this process.

    Raises:
        UsageError: the sender's script defines it, which is not run here.
    """
    try:
        return pickle.loads(pickled)
    except AttributeError as error:
        if "__main__" not in str(error):
            raise
        raise UsageError(
            f"worker processes cannot use definitions of the script: {error}",
            hint="define it in a module and import that, or use one worker",
        ) from error


def _follow(environment: Mapping[str, str]) -> None:
    """Take over another process's environment, except for variables set by imports here.

    A library may tell itself through the environment where its parts lie (SAPIEN does), whether or not the other
    process has imported it too.
    """
    block = Path("/proc/self/environ").read_bytes()  # as this process began, or the one that it was forked from
    entries = [os.fsdecode(entry).partition("=") for entry in block.split(b"\0") if entry]
    began = {name: value for name, _, value in entries}
    for name in began.keys() - environment.keys():
        os.environ.pop(name, None)
    os.environ.update({name: value for name, value in environment.items() if began.get(name) != value})


class _ToParent(logging.Handler):
    """Sends log records to the process that logs for all."""

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


SAFE_PATH = "PYTHONSAFEPATH"
"""Python's switch: nothing is imported from the current folder."""

UNTOLD = "ignore:resource_tracker:UserWarning"
"""Hides a warning: Python's resource tracker reports what it removes after a process was killed."""


preloaded: list[str] = []
"""Modules that the process imports from which others are forked."""


@dataclass
class _Server:
    """The process from which others are forked.

    Args:
        forked: it is a fork of this one, so that nothing is imported twice, not a new program.
    """

    forked: bool = False


_server = _Server()


def preload(modules: Sequence[str]) -> None:
    """Begin the process from which others are forked, with some modules; see :func:`vcage.base.workers.preload_module`.

    Args:
        modules: their names.
    """
    preloaded.extend(modules)
    if own_process.runs_a_command and threading.active_count() == 1:
        for name in modules:
            with suppress(ImportError):  # its users report it
                import_module(name)
        _server.forked = True
    process_context()


@cache
def process_context() -> SpawnContext | ForkServerContext:
    """Return the start method of processes: forked from one that never works.

    A child of this process would lack the threads of its renderer; the one that never works may be a fork of this
    process from before (:func:`preload`). Where there can be no socket, as when the path in ``TMPDIR`` is
    too long, each process is spawned.
    """
    sweep_scratch()
    multiprocessing.set_forkserver_preload(preloaded)  # Python's default is the script that runs
    sys.warnoptions.append(UNTOLD)
    resource_tracker.ensure_running()  # which would let Ctrl-C through again
    sys.warnoptions.remove(UNTOLD)
    through = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # Ctrl-C is this process's business
    safe = os.environ.get(SAFE_PATH)
    os.environ[SAFE_PATH] = safe or "1"  # else it would import modules from the current folder
    try:
        mark_scratch(Path(get_temp_dir()))  # in which its socket lies
        with _server_forked() if _server.forked else nullcontext():
            forkserver.ensure_running()
    except OSError:
        return multiprocessing.get_context("spawn")
    finally:
        if safe is None:
            del os.environ[SAFE_PATH]
        signal.pthread_sigmask(signal.SIG_SETMASK, through)
    return multiprocessing.get_context("forkserver")


@contextmanager
def _server_forked() -> Iterator[None]:
    """Let Python's fork server be a fork of this process inside, where it would be a new program."""
    usual = util.spawnv_passfds
    util.spawnv_passfds = _fork_of_this
    try:
        yield
    finally:
        util.spawnv_passfds = usual


def _fork_of_this(path: bytes, args: Sequence[Any], passfds: Sequence[int]) -> int:
    """Fork the server, in place of :func:`multiprocessing.util.spawnv_passfds`; return its process id.

    Args:
        path, args: of the new program, which is not begun.
        passfds: descriptors of its socket, and of the pipe that tells it when all processes have ended.
    """
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):  # closed
            stream.flush()
    number = os.fork()
    if number == 0:
        _serve_and_exit(*passfds)
    return number


def _serve_and_exit(listener: int, alive: int) -> None:
    """Be the server in a fork. Its stack is never left, so that nothing of the other process is closed or cleaned up
    in it."""
    code = 1
    try:
        _become_server(listener, alive)
    except SystemExit:  # all processes have ended
        code = 0
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(code)


def _become_server(listener: int, alive: int) -> None:
    """Serve as Python's fork server in a fork of another process, until all processes have ended."""
    tracker = resource_tracker.getfd()
    assert tracker is not None  # it was begun before
    kept = sorted({0, 1, 2, listener, alive, tracker})
    for before, after in zip(kept, [*kept[1:], os.sysconf("SC_OPEN_MAX")], strict=True):
        os.closerange(before + 1, after)  # locks among them, which would outlast the other process
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.environ.pop(SAFE_PATH, None)
    modules = [*preloaded]
    preloaded.clear()
    process_context.cache_clear()
    forkserver._forkserver.__init__()  # a process forked from here may begin a server of its own
    forkserver.main(listener, alive, modules)


def remove_server_files() -> None:
    """Remove temporary files of the fork server, which a process that ends by ``os._exit`` would leave behind."""
    if process_context.cache_info().currsize:
        shutil.rmtree(get_temp_dir(), ignore_errors=True)


_starting = threading.Lock()


def start(process: BaseProcess) -> None:
    """Start a process that does not run this program's script, as Python's own do to find what the script defines: so a
    script needs no ``if __name__ == "__main__"``."""
    with _starting:
        usual = spawn.get_preparation_data

        def without_script(name: str) -> dict[str, Any]:
            return {
                key: value
                for key, value in usual(name).items()
                if name != process.name or not key.startswith("init_main")
            }

        spawn.get_preparation_data = without_script
        try:
            process.start()
        finally:
            spawn.get_preparation_data = usual
