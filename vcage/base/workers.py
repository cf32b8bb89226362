"""Worker processes, and the number of threads of numerical libraries.

Worker processes end with their parent, however it ends.
"""

from __future__ import annotations

import logging
import os
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from math import inf
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, Generic, Self, TypeVar

from threadpoolctl import ThreadpoolController

from vcage.base.errors import PartlyDone
from vcage.base.worker_process import FAILED, SAID, preload, process_context, serve, start

log = logging.getLogger(__name__)

T = TypeVar("T")
R = TypeVar("R")


def cores() -> int:
    """Processor cores that this process may use."""
    return len(os.sched_getaffinity(0))


def preload_module(*modules: str) -> None:
    """Let later processes begin with modules, which are imported once for all.

    In the process of a command they are imported here; elsewhere in a separate process, in parallel to this one. To be
    called before any process is started and before anything is drawn. With one core nothing happens.

    Args:
        modules: their names. An ImportError is left to its users; after another error no process can start.
    """
    if cores() > 1:
        preload(modules)


def map_in_processes(work: Callable[[T], R], tasks: Sequence[T], workers: int) -> Iterator[R]:
    """Yield results of ``work`` as they are finished, not in the order of the tasks.

    With one worker or one task the work happens in this process. An error of a task ends the others and is raised here;
    so does leaving the iterator.

    Args:
        work: a function of a module; task, result and errors are pickled.
        tasks: what to work on.
        workers: processes at most.

    Raises:
        PartlyDone: see :class:`Processes`.
    """
    crew = Processes(work, min(workers, len(tasks))) if workers > 1 and len(tasks) > 1 else SameProcess(work)
    with crew:
        for task in tasks:
            crew.submit(task)
        yield from crew.results()


def map_in_threads(work: Callable[[T], R], tasks: Iterable[T]) -> Iterator[R]:
    """Yield results of ``work`` in the order of the tasks, a thread for each core.

    At most one result per thread waits, so results may be large.
    """
    waiting: deque[Future[R]] = deque()
    with ThreadPoolExecutor(cores()) as pool:
        try:
            for task in tasks:
                waiting.append(pool.submit(work, task))
                if len(waiting) > cores():
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        finally:
            for one in waiting:
                one.cancel()


class SameProcess(Generic[T, R]):
    """Replacement of :class:`Processes` in this process: one task after the other, when a result is asked for.

    Args:
        work: a function.
    """

    def __init__(self, work: Callable[[T], R]):
        self._work = work
        self._waiting: deque[T] = deque()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._waiting.clear()

    def submit(self, task: T) -> None:
        """Add a task."""
        self._waiting.append(task)

    def results(self) -> Iterator[R]:
        """Yield the results in the order of the tasks, until none is left; more may be submitted meanwhile."""
        while self._waiting:
            yield self._work(self._waiting.popleft())


@dataclass(eq=False)
class _Process:
    """A process, the connection to it, its task, and the task's start (:func:`time.monotonic`)."""

    process: BaseProcess
    connection: Connection
    task: Any
    since: float

    def dismiss(self, within_s: float = 5.0) -> None:
        """Let an idle process end, so that it cleans up."""
        self.connection.close()
        self.process.join(within_s)
        self.process.kill()

    def end(self) -> None:
        self.process.kill()
        self.process.join()
        self.connection.close()


class Processes(Generic[T, R]):
    """Processes that work on tasks, each on one at a time; a context manager that ends them all.

    Each has a pipe of its own, so one killed from outside, or ended here after too long a silence,
    loses only its task, which goes to another.

    Args:
        work: a function of a module; task, result and errors are pickled.
        workers: processes at most.
        limit_s: seconds after which a silent process is ended; None for no limit. Or a function of a task and the
            seconds since it began, which returns the seconds until it shall be asked again; 0 or less ends the process.
        max_tries: processes that may be lost over one task before it is given up.
        lost: returns the result of a task that lost its process, given the task and how, in place of other tries.
    """

    def __init__(
        self,
        work: Callable[[T], R],
        workers: int,
        limit_s: float | Callable[[T, float], float] | None = None,
        max_tries: int = 3,
        lost: Callable[[T, str], R] | None = None,
    ):
        self._work, self._workers, self._limit_s, self._max_tries = work, workers, limit_s, max_tries
        self._result_of_lost = lost
        self._waiting: deque[tuple[T, int]] = deque()
        self._busy: list[_Process] = []
        self._idle: list[_Process] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for process in self._idle:
            process.dismiss()
        for process in self._busy:
            process.end()

    def submit(self, task: T) -> None:
        """Add a task; it begins as soon as a process is free."""
        self._waiting.append((task, 1))
        self._begin()

    def results(self) -> Iterator[R]:
        """Yield the results as they arrive, until none remains; more may be submitted meanwhile.

        Raises:
            PartlyDone: a task lost ``max_tries`` processes, as when the system takes their memory.
            Exception: raised by a task.
        """
        while self._busy:
            for process in self._answered_processes():
                self._busy.remove(process)
                try:
                    kind, value = process.connection.recv()
                except (EOFError, OSError):
                    yield from self._lost(process, "was ended from outside")
                    continue
                if kind == SAID:
                    name, level, text = value
                    logging.getLogger(name).log(level, "%s", text)
                    self._busy.append(process)
                    continue
                self._idle.append(process)
                self._begin()
                if kind == FAILED:
                    raise value
                yield value
            for process in [process for process in self._busy if self._seconds_left(process) <= 0]:
                self._busy.remove(process)
                seconds = time.monotonic() - process.since
                yield from self._lost(process, f"gave no answer and was ended after {seconds:.0f} s")

    def _begin(self) -> None:
        """Give waiting tasks to free processes, or to new ones up to the limit."""
        while self._waiting and len(self._busy) < self._workers:
            process = self._idle.pop() if self._idle else self._started()
            process.task, process.since = self._waiting.popleft(), time.monotonic()
            try:
                process.connection.send(process.task[0])
            except OSError:
                process.since = time.monotonic()  # ended while it was idle: its pipe says so when it is read
            self._busy.append(process)

    def _started(self) -> _Process:
        ours, theirs = process_context().Pipe()
        level = logging.getLogger().getEffectiveLevel()
        process = process_context().Process(target=serve, args=(theirs, level, dict(os.environ)), daemon=True)
        start(process)
        theirs.close()  # so that ours ends with the process
        with suppress(OSError):  # it has ended already: its pipe says so when it is read
            ours.send(self._work)
        return _Process(process, ours, None, 0.0)

    def _answered_processes(self) -> list[_Process]:
        patience = max(0.0, min(map(self._seconds_left, self._busy)))
        ready = wait([process.connection for process in self._busy], None if patience == inf else patience)
        return [process for process in self._busy if process.connection in ready]

    def _seconds_left(self, process: _Process) -> float:
        """Seconds that a process may still be silent."""
        elapsed = time.monotonic() - process.since
        if callable(self._limit_s):
            return self._limit_s(process.task[0], elapsed)
        return inf if self._limit_s is None else self._limit_s - elapsed

    def _lost(self, process: _Process, how: str) -> Iterator[R]:
        """End what is left of a process; yield the result of its task, or let another process try it."""
        task, tries = process.task
        process.end()
        if self._result_of_lost is not None:
            self._begin()
            yield self._result_of_lost(task, how)
            return
        if tries >= self._max_tries:
            raise PartlyDone(
                f"a worker process {how}, {tries} times with the same work, perhaps for want of memory",
                hint="run the same command again with fewer --workers; what is finished is kept",
            )
        log.warning("a worker process %s; its task restarts", how)
        self._waiting.appendleft((task, tries + 1))
        self._begin()


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """One thread for BLAS inside (a ``with`` or a decorated function).

    More cost more than they give on small matrices, above all on a busy machine, and change the last digits of sums
    with their number.
    """
    with _controller().limit(limits=1, user_api="blas"):
        yield


@cache
def _controller() -> ThreadpoolController:
    """Looking for the libraries is slow, so once."""
    import scipy.linalg  # noqa: F401  its BLAS is another one than numpy's, and must be loaded to be found

    return ThreadpoolController()
