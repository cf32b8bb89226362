"""Times beside the frames of a recording: their rate and spacing."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import h5py
import numpy as np
from numpy.typing import NDArray

from vcage.datasets.hdf5_contents import datasets_in, require_numbers_fit

UNITS: Mapping[float, str] = {1.0: "s", 1e-3: "ms", 1e-6: "us", 1e-9: "ns"}
"""Seconds of a unit → its name."""


@dataclass(frozen=True)
class ClockSettings:
    """Limits by which numbers are times, and times agree with evenly spaced frames.

    Args:
        within_frames: distance from the even grid up to which the frame is certain.
        shortest_period_s, longest_period_s: of a recording; they tell the unit of times.
    """

    within_frames: float = 0.5
    shortest_period_s: float = 1e-3
    longest_period_s: float = 2.0


SETTINGS = ClockSettings()


@dataclass(frozen=True)
class Clock:
    """The times of a recording's frames.

    Args:
        key: of the dataset.
        ticks: (T,) from the first frame on, in the unit of the file.
        units: seconds of one tick, all that are plausible; none where the numbers count frames.
    """

    key: str
    ticks: NDArray[np.float64]
    units: tuple[float, ...]

    @cached_property
    def nominal_rate(self) -> float | None:
        """Frames per second to 3 digits after the point, as a whole number if the times agree with it; None
        where frames are not evenly spaced, or the unit is not certain."""
        if len(self.units) != 1:
            return None
        span = float(self.ticks[-1]) * self.units[0]
        mean = round((len(self.ticks) - 1) / span, 3) if np.isfinite(span) and span > 0 else 0.0
        rates = (rate for rate in (float(round(mean)), mean) if rate > 0)
        return next((rate for rate in rates if self.fault(rate) is None), None)

    def fault(self, fps: float) -> str | None:
        """Return why these are not the times of frames at a rate; None if each is within half a frame of the even grid.

        Of several plausible units, the one nearest to the rate counts.
        """
        if not np.all(np.isfinite(self.ticks)):
            return f"{self.key} holds NaN or infinity"
        if not self.units:
            return self._jump()
        seconds = self.ticks * min(self.units, key=lambda unit: abs(np.log(max(self._step * unit * fps, 1e-300))))
        steps = np.diff(seconds)
        if np.any(steps <= 0):
            frame = int(np.argmax(steps <= 0)) + 1
            return f"{self.key} does not grow at frame {frame} ({seconds[frame]:.4f} s after the first)"
        off = np.abs(seconds - np.arange(len(seconds)) / fps)
        worst = int(np.argmax(off))
        if off[worst] * fps <= SETTINGS.within_frames:
            return None
        return (
            f"{self.key} has frame {worst} {seconds[worst]:.4f} s after the first, at {fps:g} frames per second "
            f"it is {worst / fps:.4f} s: {off[worst] * 1000:.1f} ms off, more than half a frame"
        )

    def note(self, fps: float | None) -> str | None:
        """Return a note for the user; None where nothing is odd.

        Args:
            fps: rate that the recording states.
        """
        rate = fps or self.nominal_rate or self._usual_rate
        fault = self.fault(rate)
        if fault is not None or fps:
            return fault
        if not self.units:
            return f"{self.key} counts frames and tells no rate; give --fps"
        if len(self.units) == 1:
            return None
        may_be = " or ".join(f"{1 / (self._step * unit):g} Hz in {UNITS[unit]}" for unit in self.units)
        return f"{self.key} grows by {self._step:g} a frame, which may be {may_be}; give --fps"

    @property
    def _step(self) -> float:
        return _usual_step(self.ticks)

    @property
    def _usual_rate(self) -> float:
        """Frames per second by the usual step, in the first unit."""
        period = self._step * (self.units or (1.0,))[0]
        return 1 / period if np.isfinite(period) and period > 0 else 1.0

    def _jump(self) -> str | None:
        steps = np.diff(self.ticks)
        if np.all(steps == 1):
            return None
        frame = int(np.argmax(steps != 1)) + 1
        return (
            f"{self.key} counts frames, and frame {frame} comes {steps[frame - 1]:g} after the one before it, not 1: "
            "frames are missing, or stand twice"
        )


def clock_of(key: str, values: NDArray[np.generic]) -> Clock:
    """Return the clock of (T,) numbers, T ≥ 2; their usual step tells the unit."""
    with np.errstate(invalid="ignore"):
        first = values - values[0] if values.dtype.kind == "f" else values.astype(np.int64) - values.astype(np.int64)[0]
    ticks = first.astype(np.float64)
    usual = _usual_step(ticks)
    if usual == 1 and np.all(ticks == np.round(ticks)):
        return Clock(key, ticks, ())
    shortest, longest = SETTINGS.shortest_period_s * (1 - 1e-9), SETTINGS.longest_period_s * (1 + 1e-9)
    return Clock(key, ticks, tuple(unit for unit in UNITS if shortest <= usual * unit <= longest) or tuple(UNITS))


def _usual_step(ticks: NDArray[np.float64]) -> float:
    with np.errstate(invalid="ignore"):
        return float(np.median(np.abs(np.diff(ticks))))


STAMP = r"(time)?stamps?|ts"
"""Words that mean points in time; numbers under them are times in any form."""

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
        unknown: key → shape and type of a dataset named like a clock, but not understood.
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
        frames: pictures of a camera; a clock has that many times, or one per command.
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
