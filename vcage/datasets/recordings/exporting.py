"""Facts of a recording for a LeRobot data set, beyond its pictures and numbers."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from vcage.datasets.recordings.success import UnclearLabel


class Exportable:
    """Defaults of a recording whose layout says nothing of these."""

    SPARE_PICTURES: ClassVar[int] = 0
    """Pictures after the last command: simulators also record what the last command led to."""

    @property
    def failed(self) -> str | None:
        """Why the recording is no demonstration of its task; None where it is one, or nothing says.

        Raises:
            UnclearLabel: its label says neither true nor false.
        """
        return None

    def outcome(self) -> tuple[str | None, UnclearLabel | None]:
        """Read why the recording failed, if it says so, or the error of a label that says neither true nor false.

        Raises:
            DamagedFile: its labels cannot be read.
        """
        try:
            return self.failed, None
        except UnclearLabel as error:
            return None, error

    @property
    def task_guess(self) -> str | None:
        """A task for a recording without an instruction, such as the name of its environment."""
        return None

    @property
    def rate_hint(self) -> str:
        """How a user finds the frame rate of a recording that does not state it."""
        return "give --fps N"

    @property
    def companions(self) -> list[Path]:
        """Files beside the recording's own that describe it; an HDF5 output gets copies of them."""
        return []

    @property
    def rate_guess(self) -> float | None:
        """Frames per second that follow from timestamps, where neither the recording nor a user states a rate."""
        return None

    def time_fault(self, target: str, fps: float) -> str | None:
        """Why its times are not those of ``fps`` evenly spaced frames per second, which ``target``, one of LeRobot's
        versions, would say of them; None where they are, or nothing says."""
        del target, fps
        return None

    def left_out(self) -> dict[str, str]:
        """Recorded data that a LeRobot data set of another version does not get: key → reason."""
        return {}
