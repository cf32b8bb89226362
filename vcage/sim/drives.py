"""Commands for the drives of an arm at a physics step: one row of numbers on a fixed grid.

The steps of the grid are exact in binary and far below any visible effect: the largest, of the torque, moves an arm on
its drive by less than 5 µrad. A record of the commands needs a few bits for each, and is exact for a replay.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property

import numpy as np

GRID = {"position": 2.0**-20, "velocity": 2.0**-14, "torque": 2.0**-8}
"""Steps of target positions (rad, m), target velocities (per s) and feed-forward torques (N m, N)."""

PARTS = (*GRID, "opening")
"""Parts of a row: (n,) and (n,) of the arm's joints, (dof,) of all active joints, and the gripper's opening, which is
not rounded."""


def on_grid(part: str, values: float | np.ndarray) -> np.ndarray:
    """The nearest numbers on the grid of a part of a row."""
    values = np.asarray(values, dtype=np.float64)
    if part not in GRID:
        return values
    return np.rint(values / GRID[part]) * GRID[part] + 0.0  # no negative zero


@dataclass(frozen=True)
class DriveLayout:
    """The layout of a row.

    Args:
        joints: n, of the arm.
        dof: active joints, fingers too.
    """

    joints: int
    dof: int

    @property
    def size(self) -> int:
        """The length of a row."""
        return 2 * self.joints + self.dof + 1

    def part(self, name: str) -> slice:
        """The place of a part of :data:`PARTS`."""
        return self._slices[name]

    @cached_property
    def _slices(self) -> dict[str, slice]:
        ends = [0, self.joints, 2 * self.joints, self.size - 1, self.size]
        return {part: slice(*pair) for part, pair in zip(PARTS, itertools.pairwise(ends), strict=True)}
