"""Commands of the drives in a recorded episode, from which physics can be run again."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from vcage.sim.drives import DriveLayout
from vcage.sim.world import World


@dataclass
class DriveLog:
    """The commands of all arms at every physics step of the episode, without failed attempts.

    Args:
        settled: physics steps of the world before the first row; the arms held their first pose.
        restarts: increasing steps before which the state was restored into a new world.
        layouts: of the rows, by arm.
        rows: S rows of each arm, one for each step from ``settled`` on.
    """

    settled: int = 0
    restarts: list[int] = field(default_factory=list)
    layouts: dict[str, DriveLayout] = field(default_factory=dict)
    rows: dict[str, list[np.ndarray]] = field(default_factory=dict)

    def __len__(self) -> int:
        return max(map(len, self.rows.values()), default=0)

    def begin(self, world: World) -> None:
        """Continue with a world at its start or after a snapshot was restored; later rows are dropped."""
        if not self.layouts:
            self.settled = world.steps
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
