"""What the drives of an arm are told at a physics step, as one row of numbers, on a grid as a controller has one.

The steps of the grid are exact in binary and far finer than anything that shows: the largest, of the torque, moves an
arm on its drive by less than 5 µrad. What is told to the drives is then told in whole numbers, so that a record of it
needs a few bits for each, and the same arm can be told the same again.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property

import numpy as np

GRID = {"position": 2.0**-20, "velocity": 2.0**-14, "torque": 2.0**-8}
"""Whole steps in which the drives are told where to be (rad, m), how fast (per s) and what helps them (N m, N)."""

PARTS = (*GRID, "opening")
"""Of a row: (n,) and (n,) of the arm's joints, (dof,) of all active joints, and the gripper's opening as it is."""


def on_grid(part: str, values: float | np.ndarray) -> np.ndarray:
    """The nearest numbers that a part of a row may hold."""
    values = np.asarray(values, dtype=np.float64)
    if part not in GRID:
        return values
    return np.rint(values / GRID[part]) * GRID[part] + 0.0  # no negative zero: whole numbers have none


@dataclass(frozen=True)
class DriveLayout:
    """Where the parts of a row lie.

    Args:
        joints: n, of the arm.
        dof: active joints, fingers too.
    """

    joints: int
    dof: int

    @property
    def size(self) -> int:
        """Numbers of a row."""
        return 2 * self.joints + self.dof + 1

    def part(self, name: str) -> slice:
        """Where a part of :data:`PARTS` lies."""
        return self._slices[name]

    @cached_property
    def _slices(self) -> dict[str, slice]:
        ends = [0, self.joints, 2 * self.joints, self.size - 1, self.size]
        return {part: slice(*pair) for part, pair in zip(PARTS, itertools.pairwise(ends), strict=True)}
