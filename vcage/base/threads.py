"""How many threads the numerical libraries may use."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

import scipy.linalg  # noqa: F401  its BLAS is another one than numpy's, and must be loaded to be found
from threadpoolctl import ThreadpoolController


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
    return ThreadpoolController()
