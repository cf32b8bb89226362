"""Times beside the frames of a recording: their rate and spacing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

UNITS: Mapping[float, str] = {1.0: "s", 1e-3: "ms", 1e-6: "us", 1e-9: "ns"}
"""Seconds of a unit → its name."""


@dataclass(frozen=True)
class ClockSettings:
    """Limits by which numbers are times, and times agree with evenly spaced frames.

    Args:
        within_frames: distance from the even grid that still leaves no doubt which frame is meant.
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
        """Frames per second to 3 digits after the point, as a whole number where the times agree with that too; None
        where frames are not evenly spaced, or the unit is not certain."""
        if len(self.units) != 1:
            return None
        span = float(self.ticks[-1]) * self.units[0]
        mean = round((len(self.ticks) - 1) / span, 3) if np.isfinite(span) and span > 0 else 0.0
        rates = (rate for rate in (float(round(mean)), mean) if rate > 0)
        return next((rate for rate in rates if self.fault(rate) is None), None)

    def fault(self, fps: float) -> str | None:
        """Return why these are not the times of frames at a rate; None if each is within half a frame of the even grid.

        Where several units are plausible, the one that is nearest to the rate counts.
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
