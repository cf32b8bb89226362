"""Numbers of a recording over time: commands to the robot, and its state."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

ACT_ARM = 7
"""Numbers of an arm in ACT's commands: six joints, then the gripper."""


@dataclass(frozen=True)
class Columns:
    """Numbers over time.

    Args:
        values: (T, D).
        names: of the D numbers; empty if unknown.
        notes: for the user, on how the numbers were understood.
        sources: keys of the datasets that they were read from, from the root of their file.
    """

    values: NDArray[np.float64]
    names: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    sources: tuple[str, ...] = ()

    def numbered(self, prefix: str) -> tuple[str, ...]:
        """Return ``prefix_0``… for the D numbers."""
        return tuple(f"{prefix}_{column}" for column in range(self.values.shape[1]))

    def all_names(self) -> list[str]:
        """Return names of the D numbers; ``joint_0``… if unknown."""
        return list(self.names if len(self.names) == self.values.shape[1] else self.numbered("joint"))

    @property
    def grippers(self) -> tuple[int, ...]:
        """Columns that open and close a gripper, by their names or by ACT's order."""
        named = tuple(column for column, name in enumerate(self.names) if "gripper" in name)
        return named or act_grippers(self.values.shape[1])


def act_grippers(numbers: int) -> tuple[int, ...]:
    """Return the columns of grippers in commands of arms with six joints and a gripper each; none for other sizes."""
    return tuple(range(ACT_ARM - 1, numbers, ACT_ARM)) if numbers % ACT_ARM == 0 else ()
