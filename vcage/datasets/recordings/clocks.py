"""Timestamps beside the frames of HDF5 recordings: their rate, and whether frames are evenly spaced."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import h5py
import numpy as np
from numpy.typing import NDArray

from vcage.datasets.hdf5_limits import require_numbers_fit

KEYS = ("timestamps", "timestamp", "observations/timestamps", "observations/timestamp", "obs/timestamps", "time")


@dataclass(frozen=True)
class ClockSettings:
    """When timestamps agree with evenly spaced frames.

    Args:
        within_frames: distance from the even grid that still leaves no doubt which frame is meant.
        longest_period_s: of a recording; numbers further apart count milliseconds, microseconds or nanoseconds.
    """

    within_frames: float = 0.5
    longest_period_s: float = 2.0


SETTINGS = ClockSettings()


@dataclass(frozen=True)
class Clock:
    """The times of a recording's frames.

    Args:
        key: of the dataset.
        seconds: (T,) from the first frame on.
    """

    key: str
    seconds: NDArray[np.float64]

    @cached_property
    def rate(self) -> float | None:
        """Frames per second, to 3 digits after the point; None of times that do not grow."""
        span = float(self.seconds[-1])
        return round((len(self.seconds) - 1) / span, 3) if np.isfinite(span) and span > 0 else None

    @property
    def nominal_rate(self) -> float | None:
        """The rate, as a whole number where the times agree with that too."""
        if self.rate is None:
            return None
        whole = float(round(self.rate))
        return whole if whole > 0 and self.fault(whole) is None else self.rate

    def fault(self, fps: float) -> str | None:
        """Why these are not the times of frames at a rate; None where each is within half a frame of the even grid."""
        steps = np.diff(self.seconds)
        if not np.all(np.isfinite(self.seconds)):
            return f"{self.key} holds NaN or infinity"
        if np.any(steps <= 0):
            frame = int(np.argmax(steps <= 0)) + 1
            return f"{self.key} does not grow at frame {frame} ({self.seconds[frame]:.4f} s after the first)"
        off = np.abs(self.seconds - np.arange(len(self.seconds)) / fps)
        worst = int(np.argmax(off))
        if off[worst] * fps <= SETTINGS.within_frames:
            return None
        return (
            f"{self.key} has frame {worst} {self.seconds[worst]:.4f} s after the first, at {fps:g} frames per second "
            f"it is {worst / fps:.4f} s: {off[worst] * 1000:.1f} ms off, more than half a frame"
        )


def read_clock(part: h5py.Group, frames: int) -> Clock | None:
    """The timestamps of a recording, where it has one number for each frame; None where it does not."""
    for key in KEYS:
        found = part.get(key)
        if not (isinstance(found, h5py.Dataset) and found.dtype.kind in "fiu" and found.size == frames >= 2):
            continue
        require_numbers_fit(found)
        values = found[()].reshape(-1)
        whole = values - values[0] if values.dtype.kind == "f" else values.astype(np.int64) - np.int64(values[0])
        return Clock(key, whole.astype(np.float64) * _unit(np.abs(np.diff(whole.astype(np.float64)))))
    return None


def _unit(steps: NDArray[np.float64]) -> float:
    """Seconds of one unit: 1, or that of milliseconds, microseconds or nanoseconds where steps would be too long."""
    usual = float(np.median(steps))
    fitting = (unit for unit in (1.0, 1e-3, 1e-6, 1e-9) if usual * unit <= SETTINGS.longest_period_s)
    return next(fitting, 1.0)
