"""What the drives were told in a recorded episode, so that physics can be run again without whoever told them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from vcage.sim.drives import DriveLayout
from vcage.sim.world import World


@dataclass
class DriveLog:
    """What all arms were told at every physics step that counts: not what failed and was tried again.

    Args:
        settled: physics steps of the world before the first row, the arms told to stay where they were built.
        restarts: steps, increasing, before which the state was taken over into a world that was built afresh.
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
        """Go on with a world, where nothing was told yet or in which a snapshot was restored; what was told later than
        that is forgotten."""
        if not self.layouts:
            self.settled = world.steps
            self.layouts = {name: arm.layout for name, arm in world.arms.items()}
            self.rows = {name: [] for name in world.arms}
            return
        self._forget(world.steps)
        self.restarts = [*(step for step in self.restarts if step < world.steps), world.steps]

    def add(self, world: World) -> None:
        """What holds for the step that is about to be taken."""
        self._forget(world.steps)
        for name, arm in world.arms.items():
            self.rows[name].append(arm.drives)

    def _forget(self, step: int) -> None:
        for rows in self.rows.values():
            del rows[step - self.settled :]
