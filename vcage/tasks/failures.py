"""What ends an attempt at a sub-task, and planning whose failures say how far the attempt had come."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vcage.base.errors import VcageError
from vcage.base.geometry import Pose
from vcage.schema.episodes import AttemptStage
from vcage.sim.motion import Load, MotionFailed, MotionPlanner
from vcage.sim.trajectory import Trajectory


class TaskFailed(VcageError):
    """A step could not be planned, or the hand felt that it failed; ends the attempt.

    Args:
        stage: how far the attempt came.
    """

    code = "task_failed"

    def __init__(self, stage: AttemptStage, message: str):
        super().__init__(message)
        self.stage = stage


class StagedPlanner:
    """A planner whose failures say how far the attempt had come."""

    def __init__(self, planner: MotionPlanner, stage: AttemptStage):
        self._planner, self._stage = planner, stage

    def line(self, q: np.ndarray, pose: Pose, load: Load) -> Trajectory:
        """:meth:`MotionPlanner.line`.

        Raises:
            TaskFailed: there is no way.
        """
        try:
            return self._planner.line(q, pose, load)
        except MotionFailed as error:
            raise TaskFailed(self._stage, error.message) from error

    def move(self, q: np.ndarray, goal: np.ndarray) -> Trajectory:
        """:meth:`MotionPlanner.move`.

        Raises:
            TaskFailed: there is no way.
        """
        try:
            return self._planner.move(q, goal)
        except MotionFailed as error:
            raise TaskFailed(self._stage, error.message) from error


def joined(reasons: Sequence[str]) -> str:
    """The first three different reasons in one sentence, and how many more there are."""
    told = list(dict.fromkeys(reasons))
    more = f"; and {len(told) - 3} more" if len(told) > 3 else ""
    return ("; ".join(told[:3]) or "nothing to try") + more
