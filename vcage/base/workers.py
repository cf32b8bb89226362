"""The machine's cores: work in processes of their own, and how many threads the numerical libraries take.

Processes end with the one that started them, however it ends.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import cache
from typing import TypeVar

from threadpoolctl import ThreadpoolController

from vcage.base.errors import PartlyDone

T = TypeVar("T")
R = TypeVar("R")


def cores() -> int:
    """Processor cores that this process may use."""
    return len(os.sched_getaffinity(0))


def in_processes(work: Callable[[T], R], tasks: Sequence[T], workers: int) -> Iterator[R]:
    """Results of ``work`` as they are finished, not in the order of the tasks.

    With one worker or one task it happens in this process. An error of a task ends the others and is raised here;
    so does leaving the iterator.

    Args:
        work: a function of a module; task, result and errors are pickled.
        tasks: what to work on.
        workers: processes at most.

    Raises:
        PartlyDone: a process ended without an answer, as when the system took its memory.
    """
    if workers <= 1 or len(tasks) < 2:
        yield from map(work, tasks)
        return
    before = set(multiprocessing.active_children())
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(min(workers, len(tasks)), context, _start)
    try:
        for done in as_completed([pool.submit(work, task) for task in tasks]):
            yield done.result()
        pool.shutdown()
    except BrokenProcessPool as error:
        raise PartlyDone(
            "a worker process was ended from outside, perhaps for want of memory",
            hint="run the same command again with fewer --workers; what is finished is kept",
        ) from error
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for child in set(multiprocessing.active_children()) - before:
            child.terminate()


def _start() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's business
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """A parent that is killed cannot end its workers."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


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
