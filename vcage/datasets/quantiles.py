"""Exact quantiles of more numbers than fit into memory, by reading them a few times."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

EDGES = 4096
"""Parts that an interval is cut into per reading: 32-bit numbers take three readings, few frames fewer."""

Batches = Callable[[list[str]], Iterable[Mapping[str, NDArray[Any]]]]
"""Gives all rows of the columns that are asked for, in batches: name → (n, D) float32 or int64, finite."""


def exact_quantiles(
    read: Batches,
    ranges: Mapping[str, tuple[NDArray[Any], NDArray[Any]]],
    count: int,
    shares: Sequence[float],
) -> dict[str, NDArray[np.float64]]:
    """The same as ``numpy.quantile(all rows, shares, axis=0)``, up to rounding, for every column.

    Memory is that of one batch and of :data:`EDGES` counters for each share of each number of a row.

    Args:
        read: gives the rows; called once per reading.
        ranges: column → its (D,) smallest and (D,) largest values, in the type in which it is read.
        count: number of rows.
        shares: from 0 to 1.

    Returns:
        Column → (len(shares), D).
    """
    places = np.asarray(shares) * (count - 1)
    below = np.floor(places).astype(np.int64)
    ranks = np.concatenate([below, np.minimum(below + 1, count - 1)])
    searches = {
        name: [_RankSearch(int(low), int(high), ranks) for low, high in zip(_keys(lows), _keys(highs), strict=True)]
        for name, (lows, highs) in ranges.items()
    }
    while open_columns := [name for name, columns in searches.items() if not all(c.found for c in columns)]:
        for batch in read(open_columns):
            for name in open_columns:
                keys = np.sort(_keys(batch[name].astype(ranges[name][0].dtype, copy=False)), axis=0)
                for search, column in zip(searches[name], keys.T, strict=True):
                    search.see(column)
        for name in open_columns:
            for search in searches[name]:
                search.narrow()
    return {
        name: _between(_values(np.stack([c.low for c in columns], axis=1), ranges[name][0].dtype), places - below)
        for name, columns in searches.items()
    }


def _between(neighbours: NDArray[np.float64], part: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2 Q, D) values below and above → (Q, D), by ``part`` of the way from one to the other."""
    low, high = np.split(neighbours, 2)
    return low + (high - low) * part[:, None]


def _keys(values: NDArray[Any]) -> NDArray[np.int64]:
    """Integers in the order of the numbers; those of float32 are its bits, which count up with it from zero on."""
    if values.dtype == np.int64:
        return values
    bits = np.ascontiguousarray(values, np.float32).view(np.int32).astype(np.int64)
    return np.where(bits < 0, -(bits & 0x7FFFFFFF), bits)


def _values(keys: NDArray[np.int64], dtype: np.dtype[Any]) -> NDArray[np.float64]:
    """The numbers that have these :func:`_keys`."""
    if dtype == np.int64:
        return keys.astype(np.float64)
    magnitude = np.abs(keys).astype(np.int32).view(np.float32).astype(np.float64)
    return np.where(keys < 0, -magnitude, magnitude)


class _RankSearch:
    """Which key has which rank among the keys of one column: an interval per rank that every reading narrows.

    Args:
        low: smallest key.
        high: largest key.
        ranks: (R,) from 0; rank r is the key at r when all are sorted.
    """

    def __init__(self, low: int, high: int, ranks: NDArray[np.int64]):
        self._ranks = ranks
        self.low = np.full(len(ranks), low)
        self._high = np.full(len(ranks), high)
        self._cut()

    @property
    def found(self) -> bool:
        """Whether ``low`` holds the keys of all ranks."""
        return bool((self.low == self._high).all())

    def see(self, keys: NDArray[np.int64]) -> None:
        """Count some sorted keys of the column."""
        self._smaller += np.searchsorted(keys, self._edges)

    def narrow(self) -> None:
        """Use what was counted since the last time; all keys were seen once."""
        if self.found:
            return
        after = np.searchsorted(self._smaller, self._ranks, side="right")  # first edge with more keys below it
        edges = np.concatenate([[self.low.min()], self._edges, [self._high.max() + 1]])
        self.low = np.maximum(self.low, edges[after])
        self._high = np.minimum(self._high, edges[after + 1] - 1)
        self._cut()

    def _cut(self) -> None:
        spans = np.unique(np.stack([self.low, self._high], axis=1), axis=0)
        widths = spans[:, 1:] - spans[:, :1] + 1
        self._edges = np.unique(spans[:, :1] + widths * np.arange(1, EDGES) // EDGES)
        self._smaller = np.zeros(len(self._edges), np.int64)
