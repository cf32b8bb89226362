"""Commands for the drives of an arm: one row of numbers on a fixed grid for each physics step, from which physics can
be run again.

The steps of the grid are exact in binary and far below any visible effect: the largest, of the torque, moves an arm on
its drive by less than 5 µrad. A record of the commands needs a few bits for each, and is exact for a replay.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from vcage.sim.world import World

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


@dataclass
class DriveLog:
    """The commands of all arms at every physics step of the episode, without failed attempts.

    Args:
        settled: physics steps of the world before the first row; the arms held their first pose.
        restarts: increasing steps before which the state was restored into a new world.
        layouts: of the rows, by arm.
        rows: S rows of each arm, one for each step from ``settled`` on.
        frames_from: physics step of the first frame, as that of ``settled``; recordings of 0.1.0 count from 0, so their
            first frame is up to one later than their first row.
    """

    settled: int = 0
    restarts: list[int] = field(default_factory=list)
    layouts: dict[str, DriveLayout] = field(default_factory=dict)
    rows: dict[str, list[np.ndarray]] = field(default_factory=dict)
    frames_from: int = 0

    def __len__(self) -> int:
        return max(map(len, self.rows.values()), default=0)

    def begin(self, world: World) -> None:
        """Continue with a world at its start or after a snapshot was restored; later rows are dropped."""
        if not self.layouts:
            self.settled = self.frames_from = world.steps
            self.layouts = {name: arm.layout for name, arm in world.arms.items()}
            self.rows = {name: [] for name in world.arms}
            return
        self._drop_from(world.steps)
        self.restarts = [*(step for step in self.restarts if step < world.steps), world.steps]

    def add(self, world: World) -> None:
        """Add the commands for the next step."""
        self._drop_from(world.steps)
        for name, arm in world.arms.items():
            self.rows[name].append(arm.drives)

    def _drop_from(self, step: int) -> None:
        for rows in self.rows.values():
            del rows[step - self.settled :]
