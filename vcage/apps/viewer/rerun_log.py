"""Rows on two timelines, seconds and indices of frames, in one Rerun recording. The one place that imports Rerun."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vcage.base.commands import pip_command
from vcage.base.errors import MissingDependency
from vcage.base.geometry import Pose

try:
    import rerun as rr
    import rerun.blueprint as rrb
except ImportError as error:
    raise MissingDependency(f"Rerun cannot be imported: {error}", command=pip_command("vcage[view]")) from error

# Otherwise a mistake of ours would be a warning, and a hole in the recording.
rr.set_strict_mode(True)

__all__ = ["Clock", "RerunLog", "entity", "rr", "rrb", "xyzw"]

TIME, STEP = "time", "timestep"
"""Names of the timelines: seconds, and indices of frames. The viewer begins with the first by name."""


@dataclass(frozen=True)
class Clock:
    """Times of rows.

    Args:
        frames: (N,) indices of frames.
        seconds: (N,) their times; None where a recording does not say.
    """

    frames: NDArray[np.int64]
    seconds: NDArray[np.float64] | None

    @classmethod
    def steady(cls, count: int, fps: float | None) -> Clock:
        """``count`` frames from 0 on, evenly spaced."""
        frames = np.arange(count)
        return cls(frames, None if fps is None else frames / fps)

    def at(self, rows: Sequence[int]) -> Clock:
        """Some of the rows."""
        return Clock(self.frames[rows], None if self.seconds is None else self.seconds[rows])

    def __len__(self) -> int:
        return len(self.frames)

    def columns(self) -> list[rr.TimeColumn]:
        """For Rerun, times rounded to its nanoseconds."""
        columns = [rr.TimeColumn(STEP, sequence=self.frames)]
        if self.seconds is not None:
            nanoseconds = np.round(self.seconds * 1e9).astype("timedelta64[ns]")
            columns.append(rr.TimeColumn(TIME, duration=nanoseconds))
        return columns


class RerunLog:
    """Writes into one Rerun recording.

    Args:
        stream: the recording; where it goes, to a file or to a viewer, is its own affair.
    """

    def __init__(self, stream: rr.RecordingStream):
        self._stream = stream

    def always(self, entity: str, what: rr.AsComponents) -> None:
        """Log a component of an entity that holds at all times."""
        self._stream.log(entity, what, static=True)

    def rows(self, entity: str, clock: Clock, columns: rr.ComponentColumnList) -> None:
        """One row of ``columns`` at each time of ``clock``.

        Args:
            entity: path in the recording.
            clock: N times.
            columns: N rows, of a kind that Rerun knows.
        """
        self._stream.send_columns(entity, clock.columns(), columns)

    def numbers(self, entity: str, clock: Clock, values: ArrayLike) -> None:
        """A number at each time.

        Args:
            entity: path in the recording.
            clock: N times.
            values: (N,).
        """
        self.rows(entity, clock, rr.Scalars.columns(scalars=np.asarray(values, np.float64)))

    def poses(self, entity: str, clock: Clock, positions: ArrayLike, quaternions: ArrayLike) -> None:
        """Log the poses of an entity in its parent's frame.

        Args:
            entity: path in the recording.
            clock: N times.
            positions: (N, 3), metres.
            quaternions: (N, 4) wxyz.
        """
        columns = rr.Transform3D.columns(translation=np.asarray(positions), quaternion=xyzw(quaternions))
        self.rows(entity, clock, columns)

    def path(self, entity: str, clock: Clock, poses: Sequence[Pose]) -> None:
        """:meth:`poses`, of poses.

        Args:
            entity: path in the recording.
            clock: N times.
            poses: N, in the frame of its parent.
        """
        self.poses(entity, clock, [pose.p for pose in poses], [pose.q for pose in poses])


def xyzw(quaternions: ArrayLike) -> NDArray[np.float64]:
    """Quaternions (..., 4) in Rerun's order, of ours, which are wxyz.

    Rerun 0.23 turns arrays into its own types under any NumPy, but its types into arrays only under NumPy 2.
    """
    return np.roll(np.asarray(quaternions, np.float64), -1, axis=-1)


def entity(*parts: str) -> str:
    """The path of an entity, whatever characters its parts have."""
    return rr.new_entity_path(list(parts))
