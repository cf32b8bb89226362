"""Counts of the values of a data set's columns, by which quantiles are found without reading its frames again.

Values whose sign, exponent and first bits agree are counted together, with the least and the greatest of them. Counts
of parts add up to those of the whole, whatever the order, so a data set can grow without its old frames being read.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile
from vcage.datasets.lerobot.parquet import COMPRESSION, FETCH_AGAIN, read_table

VALUE_COUNTS = Path("meta/value_counts.parquet")
"""Written beside the statistics of a large data set; LeRobot does not read it."""


@dataclass(frozen=True)
class CountingSettings:
    """Resolution of the counts of values.

    Args:
        bits: of a number's mantissa that tell values apart; a quantile is off by 2^-bits of itself at most.
        batch_frames: frames that are counted at once.
    """

    bits: int = 10
    batch_frames: int = 16384


SETTINGS = CountingSettings()

_COLUMN_BITS = 24
"""A place is a number's column, and below it these bits for its sign, exponent and first bits."""


@dataclass(frozen=True)
class _Counts:
    """Of one feature; arrays of one entry for each place that occurs, sorted by it."""

    place: NDArray[np.int64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    count: NDArray[np.int64]

    @classmethod
    def summed(cls, low: NDArray[np.float64], high: NDArray[np.float64], count: Any, column: Any) -> _Counts:
        """Return the counts of entries in any order, of which several may have one place."""
        place = _places(low, column)
        order = np.argsort(place, kind="stable")
        first = np.flatnonzero(np.diff(place[order], prepend=np.iinfo(np.int64).min))
        return cls(
            place[order][first],
            np.minimum.reduceat(low[order], first),
            np.maximum.reduceat(high[order], first),
            np.add.reduceat(count[order], first),
        )

    @property
    def column(self) -> NDArray[np.int64]:
        return (self.place + (1 << _COLUMN_BITS - 1)) >> _COLUMN_BITS


def _places(values: NDArray[np.float64], column: Any) -> NDArray[np.int64]:
    """Return the place of each value in a column; places grow with the column, then with the value."""
    first_bits = np.abs(values).view(np.int64) >> (52 - SETTINGS.bits)
    signed = np.where(values < 0, -first_bits - 1, first_bits)
    return signed + (np.asarray(column, np.int64) << _COLUMN_BITS)


class ValueCounts:
    """Counts of the values of several features, each of one or more numbers a frame."""

    def __init__(self) -> None:
        self._counts: dict[str, _Counts] = {}
        self._waiting: dict[str, list[NDArray[np.float64]]] = {}
        self._frames_waiting = 0

    def add(self, columns: Mapping[str, NDArray[Any]]) -> None:
        """Add frames: feature → (n, D) finite numbers."""
        for name, values in columns.items():
            self._waiting.setdefault(name, []).append(values.astype(np.float64) + 0.0)  # no negative zero
        self._frames_waiting += len(next(iter(columns.values()), ()))
        if self._frames_waiting >= SETTINGS.batch_frames:
            self._count()

    def quantiles(self, name: str, shares: Sequence[float]) -> NDArray[np.float64]:
        """Return (Q, D) of a feature, interpolated between ranks, and between the values that were counted together."""
        self._count()
        counts = self._counts[name]
        ends = np.searchsorted(counts.column, np.arange(counts.column[-1] + 2))
        return np.stack([_quantiles(counts, slice(*pair), shares) for pair in pairwise(ends)], axis=1)

    def write(self, path: Path) -> None:
        """Write all counts to a Parquet file."""
        self._count()
        tables = [
            pa.table({
                "feature": pa.array([name] * len(counts.place)).dictionary_encode(),
                "number": counts.column.astype(np.int32),
                "low": counts.low,
                "high": counts.high,
                "count": counts.count,
            })
            for name, counts in sorted(self._counts.items())
        ]  # fmt: skip
        pq.write_table(pa.concat_tables(tables).unify_dictionaries(), path, compression=COMPRESSION)

    @classmethod
    def read(cls, path: Path, features: Sequence[str]) -> ValueCounts:
        """Read counts of the features of a data set.

        Raises:
            DamagedFile: the file cannot be read, or lacks a feature.
        """
        table = read_table(path, ["feature", "number", "low", "high", "count"])
        owners = np.asarray(table["feature"].to_pylist(), object)
        number, low, high, count = (table[name].to_numpy() for name in ("number", "low", "high", "count"))
        found = cls()
        for name in features:
            own = owners == name
            if not own.any():
                raise DamagedFile(f"{path} has no counts of {name}", hint=FETCH_AGAIN)
            found._counts[name] = _Counts.summed(low[own], high[own], count[own], number[own])
        return found

    def _count(self) -> None:
        for name, parts in self._waiting.items():
            values = np.concatenate(parts)
            column = np.broadcast_to(np.arange(values.shape[1]), values.shape).ravel()
            low = high = values.ravel()
            count = np.ones(low.size, np.int64)
            if name in self._counts:
                old = self._counts[name]
                low, high = np.concatenate([old.low, low]), np.concatenate([old.high, high])
                count, column = np.concatenate([old.count, count]), np.concatenate([old.column, column])
            self._counts[name] = _Counts.summed(low, high, count, column)
        self._waiting, self._frames_waiting = {}, 0


def _quantiles(counts: _Counts, own: slice, shares: Sequence[float]) -> NDArray[np.float64]:
    low, high, count = counts.low[own], counts.high[own], counts.count[own]
    after = np.cumsum(count)

    def at(rank: NDArray[np.int64]) -> NDArray[np.float64]:
        entry = np.searchsorted(after, rank, side="right")
        inside = (rank - (after - count)[entry]) / np.maximum(count[entry] - 1, 1)
        return low[entry] + (high[entry] - low[entry]) * inside

    ranks = np.asarray(shares) * (after[-1] - 1)
    below = np.floor(ranks).astype(np.int64)
    first, second = at(below), at(np.minimum(below + 1, after[-1] - 1))
    return first + (second - first) * (ranks - below)
