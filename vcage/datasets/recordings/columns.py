"""Numbers of a recording over time: commands to the robot, and its state."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

ARM_JOINTS = 6
"""Joints of an arm in ACT's 7- and 14-number commands; each arm's gripper follows them."""


@dataclass(frozen=True)
class Columns:
    """Numbers over time.

    Args:
        values: (T, D).
        names: of the D numbers; none where nobody says.
        notes: what a user must know about how they were understood.
        sources: keys of the datasets that they were read from, from the root of their file.
    """

    values: NDArray[np.float64]
    names: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    sources: tuple[str, ...] = ()

    def all_names(self) -> list[str]:
        """Names of the D numbers: ``joint_0``… where nobody says."""
        if len(self.names) == self.values.shape[1]:
            return list(self.names)
        return [f"joint_{column}" for column in range(self.values.shape[1])]


@dataclass(frozen=True)
class Motion(Columns):
    """Commands of a recording: joint positions, or poses.

    Args:
        grippers: columns that open and close a gripper.
    """

    grippers: tuple[int, ...] = ()

    @property
    def action(self) -> NDArray[np.float64]:
        """(T, D) commands."""
        return self.values


def act_grippers(numbers: int) -> tuple[int, ...]:
    """Columns of the grippers in commands of arms with six joints and a gripper each; none for other commands."""
    per_arm = ARM_JOINTS + 1
    return tuple(range(ARM_JOINTS, numbers, per_arm)) if numbers % per_arm == 0 else ()
