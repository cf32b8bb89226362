"""Joint targets over time: a command for every physics step."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Trajectory:
    """Joint targets, one for each physics step, at rest at both ends.

    Args:
        q: (T, n) positions, rad.
        velocity: (T, n) rad/s.
        acceleration: (T, n) rad/s².
        openings: (step, opening) commands for the gripper on the way, 0 closed to 1 open.
    """

    q: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    openings: tuple[tuple[int, float], ...] = field(default=())

    def __len__(self) -> int:
        return len(self.q)

    @property
    def end(self) -> np.ndarray:
        """(n,) joints at the end."""
        return self.q[-1]

    def then(self, other: Trajectory) -> Trajectory:
        """The concatenation of this trajectory and another."""
        return Trajectory(
            np.concatenate([self.q, other.q]),
            np.concatenate([self.velocity, other.velocity]),
            np.concatenate([self.acceleration, other.acceleration]),
            (*self.openings, *((step + len(self), opening) for step, opening in other.openings)),
        )
