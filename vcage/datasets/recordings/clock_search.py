"""Clocks of HDF5 recordings, found by what their keys say."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass

import h5py
import numpy as np
from numpy.typing import NDArray

from vcage.datasets.hdf5_contents import datasets_in
from vcage.datasets.hdf5_limits import require_numbers_fit
from vcage.datasets.recordings.clocks import SETTINGS, Clock, clock_of

STAMP = r"(time)?stamps?|ts"
"""Words that mean points in time; numbers under them are times whatever they look like."""

TIME = r"times?|clocks?"
"""Words that may mean points in time or durations; numbers under them are times if they grow with every frame."""

DURATION = (
    r"since|until|remaining|durations?|latency|delays?|inference|budget|limit|steps?|contact|air|phase|fraction|ratio"
)
"""Words beside these that mean something else."""

PART = r"n?secs?|nanosecs?"
"""Last part of the key of half a time."""

HALF = r"_(n?secs?|nano(s|secs?|seconds?)|seconds?)"
"""End of the key of what may be half a time: nanoseconds start again, and seconds repeat. It is a time if it grows."""


@dataclass(frozen=True)
class Clocks:
    """The times that a recording states for its frames.

    Args:
        found: the clocks, in natural order of their keys.
        unknown: key → shape and type of what is named like a clock, and is not understood.
    """

    found: tuple[Clock, ...]
    unknown: dict[str, str]

    @property
    def rate(self) -> float | None:
        """Frames per second of the first clock that tells them."""
        return next((clock.nominal_rate for clock in self.found if clock.nominal_rate), None)

    def fault(self, fps: float) -> str | None:
        """Return why the times of one are not those of frames at a rate; None where those of all are."""
        return next((fault for clock in self.found if (fault := clock.fault(fps)) is not None), None)

    def notes(self, fps: float | None) -> list[str]:
        """Return notes for the user, of a recording that states ``fps`` itself, or nothing."""
        rate = fps or self.rate
        notes = [note for clock in self.found if (note := clock.note(rate)) is not None]
        stated = [f"its frame rate is that of {clock.key}, {rate:g} Hz" for clock in self.found if clock.nominal_rate]
        unknown = ", ".join(f"{key} ({what})" for key, what in self.unknown.items())
        named = f"named like times of frames, and not understood, so that they are not checked: {unknown}"
        return notes + stated[: fps is None] + [named] * bool(unknown)


def find_clocks(part: h5py.Group, frames: int, cameras: Collection[str] = (), spare: int = 0) -> Clocks:
    """Return the clocks in a recording's part of an open file, in any group.

    Args:
        part: of the file.
        frames: pictures of a camera; a clock has as many times, or those of the commands.
        cameras: keys of pictures, from the root of the file.
        spare: pictures after the last command.
    """
    found: list[Clock] = []
    unknown: dict[str, str] = {}
    for key, dataset in datasets_in(part).items():
        stamp, time = _named(key)
        if not (stamp or time) or dataset.size is None or dataset.size < 2 or dataset.name.lstrip("/") in cameras:
            continue
        columns = dict(_columns(key, dataset, (frames, frames - spare)))
        if columns and (stamp or all(map(_grows, columns.values()))):
            found += [clock_of(name, values) for name, values in columns.items()]
        else:
            unknown[key] = f"{dataset.shape} {_type(dataset)}"
    return Clocks(tuple(found), unknown)


def _named(key: str) -> tuple[bool, bool]:
    """Tell if a key holds a word of points in time, and if it holds one of times or durations."""
    split = re.sub(r"([a-z])([A-Z])", r"\1_\2", key).lower()
    words = [word for word in re.split(r"[^a-z]+", split) if word]
    stamp, time, other = (any(re.fullmatch(p, word) for word in words) for p in (STAMP, TIME, DURATION))
    half = re.search(f"{HALF}$", split) is not None
    return stamp and not half, (time or (stamp and half)) and not other


def _columns(key: str, dataset: h5py.Dataset, lengths: Collection[int]) -> Iterator[tuple[str, NDArray[np.generic]]]:
    """Yield name and (T,) numbers of each clock in a dataset; nothing where its shape or type is none of a clock's."""
    half = re.fullmatch(PART, key.rpartition("/")[2].lower())
    if dataset.dtype.kind not in "fiu" or half:
        return
    if dataset.size in lengths:
        require_numbers_fit(dataset)
        yield key, dataset[()].reshape(-1)
    elif dataset.ndim == 2 and len(dataset) in lengths:
        require_numbers_fit(dataset)
        values = dataset[()]
        if (whole := _seconds_and_rest(values)) is not None:
            yield key, whole
        else:
            yield from ((f"{key}[:, {column}]", values[:, column]) for column in range(values.shape[1]))


def _seconds_and_rest(values: NDArray[np.generic]) -> NDArray[np.int64] | None:
    """Return (T,) nanoseconds of (T, 2) whole seconds and nano- or microseconds, as ROS has them; None otherwise."""
    numbers = values.astype(np.float64)
    if numbers.shape[1] != 2 or not np.all(np.isfinite(numbers)) or np.any(numbers != np.round(numbers)):
        return None
    seconds, rest = numbers.T
    usual = np.median(np.abs(np.diff(seconds)))
    if usual > SETTINGS.longest_period_s or rest.min() < 0 or rest.max() >= 1e9 or rest.max() == 0:
        return None
    unit = 1 if rest.max() >= 1e6 else 1000
    whole = values.astype(np.int64)
    return (whole[:, 0] - whole[0, 0]) * 10**9 + whole[:, 1] * unit


def _grows(values: NDArray[np.generic]) -> bool:
    """True if numbers grow from each to the next."""
    with np.errstate(invalid="ignore"):
        return bool(np.all(np.diff(values.astype(np.float64)) > 0))


def _type(dataset: h5py.Dataset) -> str:
    return "text" if h5py.check_string_dtype(dataset.dtype) is not None else str(dataset.dtype)
